#include "volume_vtk.h"

#include <chrono>

#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkImageReader2.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSMPTools.h>
#include <vtkSTLWriter.h>
#include <vtkShortArray.h>

using instant = std::chrono::steady_clock;

static void use_threads(int threads)
{
    if (!vtkSMPTools::SetBackend("TBB"))
        vtkSMPTools::SetBackend("STDThread");
    vtkSMPTools::Initialize(threads);
}

static double since(instant::time_point begin)
{
    return std::chrono::duration<double>(instant::now() - begin).count();
}

static void set_up(vtkFlyingEdges3D *filter, double iso)
{
    filter->SetValue(0, iso);
    filter->ComputeNormalsOn();
    filter->ComputeGradientsOff();
    filter->ComputeScalarsOff();
}

double volume_vtk_extract(const void *samples, int side, int shorts, double iso, int threads, uint64_t *triangles)
{
    use_threads(threads);
    vtkIdType count = static_cast<vtkIdType>(side) * side * side;
    vtkNew<vtkImageData> image;
    vtkNew<vtkFloatArray> floats;
    vtkNew<vtkShortArray> integers;
    image->SetDimensions(side, side, side);
    if (shorts) {
        integers->SetArray(static_cast<short *>(const_cast<void *>(samples)), count, 1);
        image->GetPointData()->SetScalars(integers);
    } else {
        floats->SetArray(static_cast<float *>(const_cast<void *>(samples)), count, 1);
        image->GetPointData()->SetScalars(floats);
    }
    vtkNew<vtkFlyingEdges3D> filter;
    filter->SetInputData(image);
    set_up(filter, iso);
    instant::time_point begin = instant::now();
    filter->Update();
    double seconds = since(begin);
    *triangles = static_cast<uint64_t>(filter->GetOutput()->GetNumberOfPolys());
    return seconds;
}

double volume_vtk_convert(const char *raw, int side, int shorts, double iso, int threads, const char *stl)
{
    use_threads(threads);
    instant::time_point begin = instant::now();
    vtkNew<vtkImageReader2> reader;
    reader->SetFileName(raw);
    reader->SetFileDimensionality(3);
    reader->SetDataExtent(0, side - 1, 0, side - 1, 0, side - 1);
    reader->SetDataByteOrderToLittleEndian();
    if (shorts)
        reader->SetDataScalarTypeToShort();
    else
        reader->SetDataScalarTypeToFloat();
    vtkNew<vtkFlyingEdges3D> filter;
    filter->SetInputConnection(reader->GetOutputPort());
    set_up(filter, iso);
    filter->ComputeNormalsOff(); /* STL keeps none of them */
    vtkNew<vtkSTLWriter> writer;
    writer->SetInputConnection(filter->GetOutputPort());
    writer->SetFileName(stl);
    writer->SetFileTypeToBinary();
    writer->Write();
    return since(begin);
}
