#include "labels_peers.h"

#include <chrono>

#include <vtkCellArray.h>
#include <vtkDiscreteFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSMPTools.h>
#include <vtkUnsignedShortArray.h>

double vtk_labels(const uint16_t *voxels, const int dims[3], const int64_t *labels, uint32_t count, int threads,
                  uint64_t *triangles)
{
    if (!vtkSMPTools::SetBackend("TBB"))
        vtkSMPTools::SetBackend("STDThread");
    vtkSMPTools::Initialize(threads);
    vtkNew<vtkImageData> image;
    image->SetDimensions(dims[0], dims[1], dims[2]);
    vtkNew<vtkUnsignedShortArray> array;
    array->SetArray(const_cast<uint16_t *>(voxels), static_cast<vtkIdType>(dims[0]) * dims[1] * dims[2], 1);
    image->GetPointData()->SetScalars(array);
    *triangles = 0;
    auto begin = std::chrono::steady_clock::now();
    for (uint32_t n = 0; n < count; n++) {
        vtkNew<vtkDiscreteFlyingEdges3D> filter;
        filter->SetInputData(image);
        filter->SetValue(0, static_cast<double>(labels[n]));
        filter->ComputeNormalsOff();
        filter->ComputeGradientsOff();
        filter->ComputeScalarsOff();
        filter->Update();
        *triangles += static_cast<uint64_t>(filter->GetOutput()->GetNumberOfPolys());
    }
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}
