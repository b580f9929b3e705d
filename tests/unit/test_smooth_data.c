/* Smoothing of real shapes: volumes of scans, sharp edges and noise of a machine part. */
#include "../oracle/denoise.h"
#include "test_smooth_support.h"

static double volume_change(const hewn_model *model, hewn_smooth_volume volume)
{
    hewn_smooth_report report;
    double *positions = make_positions(model);
    smooth(model, &(hewn_smooth_desc){.iterations = 100, .volume = volume}, positions, &report);
    hewn_free(positions);
    return report.volume_after / report.volume_before - 1;
}

/* 100 iterations of Taubin's method: volume within 0.5 %, of dense scans without being given back. (Of those of few
 * thousand vertices, whose limbs are a few edges wide, more goes: docs/refinement.md has a table.) */
static void test_volume_of_scans(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        bool dense;
    } scans[] = {{"mesh-scan/horse.ply", true},    {"mesh-scan/spot.obj", true},
                 {"mesh-scan/homer.off", true},    {"mesh-scan/penguin_hr.obj", true},
                 {"mesh-scan/wingnut.obj", false}, {"mesh-scan/bull.off", false},
                 {"mesh-scan/femur.off", false},   {"mesh-scan/elephant.off", false},
                 {"mesh-scan/dino.off", false},    {"mesh-scan/scorpion_low_resolution.obj", false},
                 {"mesh-scan/bones.off", false},   {"mesh-scan/spider.ply", false}};
    for (size_t i = 0; i < sizeof scans / sizeof *scans; i++) {
        hewn_model model;
        if (!read_data(scans[i].name, &model))
            skip();
        double kept = volume_change(&model, HEWN_SMOOTH_VOLUME_DEFAULT),
               free = volume_change(&model, HEWN_SMOOTH_VOLUME_FREE);
        print_message("# %s: %llu vertices, volume changes by %.4f %%, free by %.3f %%\n", scans[i].name,
                      (unsigned long long)model.vertex_count, 100 * kept, 100 * free);
        assert_true(fabs(kept) < 0.005);
        assert_true((fabs(free) < 0.005) == scans[i].dense);
        hewn_model_destroy(&model);
    }
}

/* --- sharp edges -------------------------------------------------------------------------------------------------- */

/* Noise of `share` edges: how much of it may be left, and how far sharp edges may change, in degrees. */
static void try_noise(const hewn_model *clean, double share, uint64_t seed, double most_left, double most_changed)
{
    random_state random = {seed};
    hewn_model noisy = *clean;
    size_t sharp_count;
    double edge = mean_edge(clean);
    noisy.positions = make_positions(clean);
    add_noise(&noisy, share * edge, &random);
    sharp_edge *sharp = sharp_edges_find(clean, 40, &sharp_count);
    assert_non_null(sharp);
    double *bilateral = make_positions(clean), *laplacian = make_positions(clean);
    smooth(&noisy, &(hewn_smooth_desc){.method = HEWN_SMOOTH_BILATERAL}, bilateral, NULL);
    smooth(&noisy, &(hewn_smooth_desc){.method = HEWN_SMOOTH_LAPLACIAN}, laplacian, NULL);
    double start = noise_left(clean, noisy.positions), left = noise_left(clean, bilateral);
    double kept = sharp_edges_change(clean, bilateral, sharp, sharp_count);
    double blunted = sharp_edges_change(clean, laplacian, sharp, sharp_count);
    print_message(
        "# noise of %.1f edges: %.3f left by bilateral, %.3f by Laplacian; %zu sharp edges change by %.2f and "
        "%.2f degrees\n",
        share, left / start, noise_left(clean, laplacian) / start, sharp_count, kept, blunted);
    assert_true(sharp_count > 100);
    assert_true(kept < most_changed);
    assert_true(blunted > 15);
    assert_true(left < most_left * start);
    hewn_free(sharp);
    hewn_free(noisy.positions);
    hewn_free(bilateral);
    hewn_free(laplacian);
}

static void test_machine_part(void **state)
{
    (void)state;
    hewn_model clean;
    if (!read_data("mesh-cad/fandisk.off", &clean))
        skip();
    for (uint64_t seed = 1; seed <= 3; seed++)
        try_noise(&clean, 0.1, seed, 1.0 / 3, 3);
    try_noise(&clean, 0.3, 1, 0.4, 10);
    hewn_model_destroy(&clean);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_volume_of_scans),
        cmocka_unit_test(test_machine_part),
    };
    return cmocka_run_group_tests_name("smooth_data", tests, NULL, NULL);
}
