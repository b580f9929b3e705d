#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkQuadricDecimation.h>

#include <chrono>
#include <cstdlib>

#include "samples.h"
#include "simplify_peers.h"

simplified vtk_quadric(const peer_input *input, uint64_t target)
{
    vtkNew<vtkPolyData> data;
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
    vtkNew<vtkQuadricDecimation> filter;
    filter->SetInputData(data);
    filter->SetTargetReduction(1 - static_cast<double>(target) / static_cast<double>(input->triangle_count));
    auto begin = std::chrono::steady_clock::now();
    double processor = bench_processor_now();
    filter->Update();
    simplified out = {};
    out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    out.processor_seconds = bench_processor_now() - processor;
    vtkPolyData *result = filter->GetOutput();
    out.vertex_count = static_cast<uint64_t>(result->GetNumberOfPoints());
    out.triangle_count = static_cast<uint64_t>(result->GetNumberOfPolys());
    out.positions = static_cast<double *>(malloc(out.vertex_count * 3 * sizeof(double)));
    out.indices = static_cast<uint32_t *>(malloc(out.triangle_count * 3 * sizeof(uint32_t)));
    for (uint64_t v = 0; v < out.vertex_count; v++)
        result->GetPoint(static_cast<vtkIdType>(v), out.positions + 3 * v);
    vtkIdType count;
    const vtkIdType *corners;
    uint64_t t = 0;
    for (result->GetPolys()->InitTraversal(); result->GetPolys()->GetNextCell(count, corners); t++)
        for (uint64_t k = 0; k < 3; k++)
            out.indices[3 * t + k] = static_cast<uint32_t>(corners[k]);
    return out;
}
