#include <meshoptimizer.h>

#include <chrono>
#include <cstdlib>
#include <vector>

#include "samples.h"
#include "simplify_peers.h"

/* Vertices of the result are those of the input; unused ones are left out. */
simplified meshoptimizer(const peer_input *input, uint64_t target)
{
    std::vector<float> positions(input->positions, input->positions + 3 * input->vertex_count);
    std::vector<unsigned> indices(3 * input->triangle_count);
    auto begin = std::chrono::steady_clock::now();
    double processor = bench_processor_now();
    size_t count = meshopt_simplify(indices.data(), input->indices, indices.size(), positions.data(),
                                    input->vertex_count, 3 * sizeof(float), 3 * target, 1e9F);
    simplified out = {};
    out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    out.processor_seconds = bench_processor_now() - processor;
    std::vector<uint32_t> number(input->vertex_count, ~0U);
    out.triangle_count = count / 3;
    out.positions = static_cast<double *>(malloc(input->vertex_count * 3 * sizeof(double)));
    out.indices = static_cast<uint32_t *>(malloc(count * sizeof(uint32_t)));
    for (size_t i = 0; i < count; i++) {
        uint32_t v = indices[i];
        if (number[v] == ~0U) {
            number[v] = static_cast<uint32_t>(out.vertex_count++);
            for (size_t axis = 0; axis < 3; axis++)
                out.positions[3 * static_cast<size_t>(number[v]) + axis] = static_cast<double>(positions[3 * v + axis]);
        }
        out.indices[i] = number[v];
    }
    return out;
}
