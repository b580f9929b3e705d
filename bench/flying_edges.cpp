#include "flying_edges.h"

#include <chrono>

#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSMPTools.h>

const char *flying_edges_backend(void)
{
    return vtkSMPTools::GetBackend();
}

double flying_edges_run(const float *values, size_t samples, double origin, double step, int threads,
                        uint64_t *vertices, uint64_t *triangles)
{
    if (!vtkSMPTools::SetBackend("TBB"))
        vtkSMPTools::SetBackend("STDThread");
    vtkSMPTools::Initialize(threads);
    int side = static_cast<int>(samples);
    vtkNew<vtkImageData> image;
    image->SetDimensions(side, side, side);
    image->SetOrigin(origin, origin, origin);
    image->SetSpacing(step, step, step);
    vtkNew<vtkFloatArray> array;
    array->SetArray(const_cast<float *>(values), static_cast<vtkIdType>(samples * samples * samples), 1);
    image->GetPointData()->SetScalars(array);
    vtkNew<vtkFlyingEdges3D> filter;
    filter->SetInputData(image);
    filter->SetValue(0, 0.0);
    filter->ComputeNormalsOn();
    filter->ComputeGradientsOff();
    filter->ComputeScalarsOff();
    auto begin = std::chrono::steady_clock::now();
    filter->Update();
    std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
    *vertices = static_cast<uint64_t>(filter->GetOutput()->GetNumberOfPoints());
    *triangles = static_cast<uint64_t>(filter->GetOutput()->GetNumberOfPolys());
    return seconds.count();
}
