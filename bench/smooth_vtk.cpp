#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmoothPolyDataFilter.h>
#include <vtkWindowedSincPolyDataFilter.h>

#include <chrono>

#include "smooth_peers.h"

static void fill(vtkPolyData *data, const peer_input *input)
{
    vtkNew<vtkPoints> points;
    points->SetDataType(VTK_DOUBLE);
    points->SetNumberOfPoints(static_cast<vtkIdType>(input->vertex_count));
    for (uint64_t v = 0; v < input->vertex_count; v++)
        points->SetPoint(static_cast<vtkIdType>(v), input->positions + 3 * v);
    vtkNew<vtkCellArray> faces;
    for (uint64_t t = 0; t < input->triangle_count; t++) {
        const uint32_t *at = input->indices + 3 * t;
        const vtkIdType corners[3] = {at[0], at[1], at[2]};
        faces->InsertNextCell(3, corners);
    }
    data->SetPoints(points);
    data->SetPolys(faces);
}

template <typename Filter>
static double run(Filter *filter, const peer_input *input, double *positions)
{
    vtkNew<vtkPolyData> data;
    fill(data, input);
    filter->SetInputData(data);
    auto begin = std::chrono::steady_clock::now();
    filter->Update();
    double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    for (uint64_t v = 0; v < input->vertex_count; v++)
        filter->GetOutput()->GetPoint(static_cast<vtkIdType>(v), positions + 3 * v);
    return seconds;
}

double vtk_windowed_sinc(const peer_input *input, int iterations, double passband, double angle, double *positions)
{
    vtkNew<vtkWindowedSincPolyDataFilter> filter;
    filter->SetNumberOfIterations(iterations);
    filter->SetPassBand(passband);
    filter->SetFeatureEdgeSmoothing(angle > 0);
    filter->SetFeatureAngle(angle > 0 ? angle : 45);
    filter->BoundarySmoothingOn();
    filter->NormalizeCoordinatesOn();
    return run(filter.Get(), input, positions);
}

double vtk_laplace(const peer_input *input, int iterations, double *positions)
{
    vtkNew<vtkSmoothPolyDataFilter> filter;
    filter->SetNumberOfIterations(iterations);
    filter->SetRelaxationFactor(0.5);
    filter->FeatureEdgeSmoothingOff();
    return run(filter.Get(), input, positions);
}
