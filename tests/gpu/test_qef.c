/* The least squares of planes in a cell, on the device and on the host, against an oracle in double that works by other
 * means. */
#include <math.h>

#include "gpu_test.h"

#include "../oracle/qef.h"
#include "iso/host_qef.h"

extern const char hewn_text_qef_probe[];

enum { PLANES = 17, STRIDE = 8 + 6 * PLANES, COUNT = 4096 };

/* The share below which the shader takes singular values for 0. */
#define CUT 0.05

typedef struct problem {
    float lo[3], hi[3];
    uint32_t crossings, planes;
    float values[PLANES][2][3]; /* point and normal */
} problem;

typedef struct solution {
    float at[3], rank, free[3];
} solution;

_Static_assert(sizeof(problem) == STRIDE * sizeof(float), "as the kernel reads it");
_Static_assert(sizeof(solution) == 7 * sizeof(float), "as the kernel writes it");

typedef struct fixture {
    hewn_device *device;
    unsigned messages;
    hewn_program *program;
    hewn_buffer in, out;
    solution *by_host; /* where the host is under test; else NULL */
    uint64_t random;
} fixture;

static int open_fixture(void **state)
{
    static fixture shared = {.random = 20021};
    shared.device = gpu_test_open(&shared.messages);
    const hewn_program_desc desc = {.name = "qef probe", .glsl = hewn_text_qef_probe, .push_bytes = 24};
    GPU_TEST_TRY(hewn_program_create(shared.device, &desc, &shared.program, &error));
    GPU_TEST_TRY(
        hewn_buffer_create(shared.device, "problems", COUNT * sizeof(problem), HEWN_BUFFER_UPLOAD, &shared.in, &error));
    GPU_TEST_TRY(hewn_buffer_create(shared.device, "solutions", COUNT * sizeof(solution), HEWN_BUFFER_READBACK,
                                    &shared.out, &error));
    *state = &shared;
    return 0;
}

static int close_fixture(void **state)
{
    fixture *f = *state;
    hewn_program_destroy(f->device, &f->program);
    hewn_buffer_destroy(f->device, &f->in);
    hewn_buffer_destroy(f->device, &f->out);
    gpu_test_close(&f->device, &f->messages);
    return 0;
}

static int by_device(void **state)
{
    ((fixture *)*state)->by_host = NULL;
    return 0;
}

static int by_host(void **state)
{
    static solution solutions[COUNT];
    ((fixture *)*state)->by_host = solutions;
    return 0;
}

static solution solve_on_host(const problem *p)
{
    hewn_qef qef;
    hewn_qef_begin(&qef);
    for (uint32_t i = 0; i < p->planes; i++)
        (i < p->crossings ? hewn_qef_add_crossing : hewn_qef_add_plane)(&qef, vec_load(p->values[i][0]),
                                                                        vec_load(p->values[i][1]));
    hewn_qef_solution solved = hewn_qef_solve(&qef, vec_load(p->lo), vec_load(p->hi));
    return (solution){{solved.at[0], solved.at[1], solved.at[2]},
                      (float)solved.rank,
                      {solved.free[0], solved.free[1], solved.free[2]}};
}

static const solution *solve(fixture *f, const problem *problems)
{
    for (int i = 0; f->by_host && i < COUNT; i++)
        f->by_host[i] = solve_on_host(&problems[i]);
    if (f->by_host)
        return f->by_host;
    memcpy(f->in.mapped, problems, COUNT * sizeof *problems);
    const struct {
        uint32_t count, stride;
        uint64_t in, out;
    } push = {COUNT, STRIDE, f->in.address, f->out.address};
    hewn_commands *commands;
    GPU_TEST_TRY(hewn_commands_begin(f->device, &commands, &error));
    hewn_commands_dispatch(commands, f->program, &push, NULL, (hewn_dispatch_size){(COUNT + 63) / 64, 1, 1});
    GPU_TEST_TRY(hewn_commands_submit(&commands, NULL, &error));
    return f->out.mapped;
}

/* --- random planes ------------------------------------------------------------------------------------------------ */

static double between(fixture *f, double lo, double hi)
{
    return lo + (hi - lo) * (gpu_test_random(&f->random) / 4294967295.0);
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void direction(fixture *f, double out[3])
{
    double size;
    do {
        for (int k = 0; k < 3; k++)
            out[k] = between(f, -1, 1);
        size = sqrt(dot(out, out));
    } while (size < 0.1 || size > 1);
    for (int k = 0; k < 3; k++)
        out[k] /= size;
}

/* A plane through `apex`, its crossing somewhere in the cell. */
static void add(fixture *f, problem *p, const double apex[3], const double normal[3], bool crossing, double noise)
{
    double at[3], off[3];
    for (int k = 0; k < 3; k++) {
        at[k] = between(f, 0, 1);
        off[k] = at[k] - apex[k];
    }
    double above = dot(normal, off);
    for (int k = 0; k < 3; k++) {
        p->values[p->planes][0][k] = (float)(at[k] - above * normal[k]);
        p->values[p->planes][1][k] = (float)(normal[k] + between(f, -noise, noise));
    }
    p->planes++;
    p->crossings += crossing ? 1 : 0;
}

static problem empty_problem(void)
{
    return (problem){.hi = {1, 1, 1}};
}

/* `kinds` planes, each met by some of the crossings, and noise in the normals. The apex may lie outside the cell. */
static problem random_problem(fixture *f, int kinds, double noise, double reach)
{
    problem p = empty_problem();
    double apex[3], normals[3][3];
    for (int k = 0; k < 3; k++) {
        apex[k] = between(f, -reach, 1 + reach);
        direction(f, normals[k]);
    }
    for (int i = 0; i < 3 + (int)(gpu_test_random(&f->random) % 10); i++)
        add(f, &p, apex, normals[i % kinds], true, noise);
    return p;
}

/* --- against the oracle ------------------------------------------------------------------------------------------- */

typedef struct tally {
    int compared, undecided, outside;
    double worst; /* distance between the two answers where there is only one */
} tally;

static oracle_qef oracle_of(const problem *p, double lo[3], double hi[3])
{
    double points[PLANES][3], normals[PLANES][3], mass[3] = {0};
    for (uint32_t i = 0; i < p->planes; i++) {
        double size = 0;
        for (int k = 0; k < 3; k++) {
            points[i][k] = (double)p->values[i][0][k];
            normals[i][k] = (double)p->values[i][1][k];
            size += normals[i][k] * normals[i][k];
            mass[k] += i < p->crossings ? points[i][k] / p->crossings : 0;
        }
        for (int k = 0; k < 3; k++)
            normals[i][k] /= sqrt(size);
    }
    for (int k = 0; k < 3; k++) {
        lo[k] = (double)p->lo[k];
        hi[k] = (double)p->hi[k];
        mass[k] = fmin(fmax(mass[k], lo[k]), hi[k]);
    }
    return oracle_qef_of((const double(*)[3])points, (const double(*)[3])normals, p->planes, mass, CUT);
}

static double distance(const double a[3], const double b[3])
{
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

static void compare(const problem *p, const solution *got, tally *sums)
{
    double lo[3], hi[3], expected[3], at[3];
    oracle_qef oracle = oracle_of(p, lo, hi);
    for (int k = 0; k < 3; k++) {
        at[k] = (double)got->at[k];
        if (!(at[k] >= lo[k] && at[k] <= hi[k]))
            fail_msg("coordinate %d is %g, outside %g to %g", k, at[k], lo[k], hi[k]);
    }
    for (int k = 1; k < 3; k++)
        if (fabs(oracle.values[k] / oracle.values[0] / CUT - 1) < 1e-3) {
            sums->undecided++; /* on the threshold: either is right */
            return;
        }
    assert_int_equal((int)got->rank, oracle.rank);
    oracle_qef_in_box(&oracle, lo, hi, expected);
    double error = oracle_qef_error(&oracle, at) / oracle.values[0];
    double least = oracle_qef_error(&oracle, expected) / oracle.values[0];
    double off = distance(at, oracle.mass), nearest = distance(expected, oracle.mass);
    bool whole = distance(expected, oracle.best) < 1e-9;
    sums->outside += whole ? 0 : 1;
    sums->compared++;
    if (oracle.rank == 3 || whole)
        sums->worst = fmax(sums->worst, distance(at, expected));
    if (!(error <= least + 5e-5) || !(off <= nearest + 2e-3))
        fail_msg(
            "rank %d: (%.8g, %.8g, %.8g) is %g off the planes and %g off the mass point; (%.8g, %.8g, %.8g) %g and %g",
            oracle.rank, at[0], at[1], at[2], error, off, expected[0], expected[1], expected[2], least, nearest);
    if (got->rank == 2.0f) {
        const double edge[3] = {(double)got->free[0], (double)got->free[1], (double)got->free[2]};
        assert_true(fabs(fabs(dot(edge, oracle.vectors[2])) - 1) < 1e-4);
    }
}

static tally compare_all(fixture *f, const problem *problems)
{
    tally sums = {0};
    const solution *got = solve(f, problems);
    for (int i = 0; i < COUNT; i++)
        compare(&problems[i], &got[i], &sums);
    return sums;
}

static problem problems[COUNT];

static void random_planes_as_the_oracle(void **state)
{
    fixture *f = *state;
    for (int kinds = 1; kinds <= 3; kinds++)
        for (int reach = 0; reach < 2; reach++)
            for (int noisy = 0; noisy < 2; noisy++) {
                for (int i = 0; i < COUNT; i++)
                    problems[i] = random_problem(f, kinds, noisy ? 0.05 : 0, reach);
                tally sums = compare_all(f, problems);
                print_message("# %d planes, reach %d, noise %d: %d compared, %d outside the cell, worst %.3g\n", kinds,
                              reach, noisy, sums.compared, sums.outside, sums.worst);
                assert_true(sums.compared > COUNT / 2 && sums.undecided < COUNT / 50 && sums.worst < 1e-4);
                assert_true(kinds == 1 || !reach || sums.outside > COUNT / 10);
            }
}

/* Boxes that are flat in an axis or two, as cells on the bounds of an open grid are, and planes that only count. */
static void flat_boxes(void **state)
{
    fixture *f = *state;
    for (int i = 0; i < COUNT; i++) {
        problems[i] = random_problem(f, 1 + i % 3, i % 2 ? 0.02 : 0, 0.5);
        for (int axis = 0; axis < 3; axis++)
            if (i >> (2 + axis) & 1)
                problems[i].lo[axis] = problems[i].hi[axis] = (float)(i % 3) / 2;
        problems[i].crossings -= i % 4 == 0 ? 1 : 0;
    }
    tally sums = compare_all(f, problems);
    assert_true(sums.compared > COUNT / 2);
}

/* --- features ----------------------------------------------------------------------------------------------------- */

/* Three planes at any angles meet in the cell: that point is found, however blunt they are, down to the threshold. */
static void corners_are_exact(void **state)
{
    fixture *f = *state;
    double apexes[COUNT][3], worst = 0;
    int sharp = 0;
    for (int i = 0; i < COUNT; i++) {
        double axis[3], lo[3], hi[3];
        problem *p = &problems[i];
        do {
            *p = empty_problem();
            direction(f, axis);
            double spread = exp(between(f, log(0.1), log(3)));
            for (int k = 0; k < 3; k++)
                apexes[i][k] = between(f, 0, 1);
            for (int plane = 0; plane < 3; plane++) {
                double normal[3], bend[3];
                direction(f, bend);
                for (int k = 0; k < 3; k++)
                    normal[k] = axis[k] + spread * bend[k];
                for (uint32_t n = 1 + gpu_test_random(&f->random) % 4; n > 0; n--) {
                    double size = sqrt(dot(normal, normal));
                    const double unit[3] = {normal[0] / size, normal[1] / size, normal[2] / size};
                    add(f, p, apexes[i], unit, true, 0);
                }
            }
        } while (oracle_of(p, lo, hi).values[2] < CUT * 1.001 * oracle_of(p, lo, hi).values[0]);
    }
    const solution *got = solve(f, problems);
    for (int i = 0; i < COUNT; i++) {
        const double at[3] = {(double)got[i].at[0], (double)got[i].at[1], (double)got[i].at[2]};
        assert_int_equal((int)got[i].rank, 3);
        worst = fmax(worst, distance(at, apexes[i]));
        sharp++;
    }
    print_message("# %d corners, worst %.3g of a cell\n", sharp, worst);
    assert_true(worst < 2e-5);
}

/* The line of two planes passes through the cell, but its point nearest to the mass point need not be in there. */
static void edges_are_hit_within_the_cell(void **state)
{
    fixture *f = *state;
    double worst = 0;
    int ends = 0;
    for (int i = 0; i < COUNT; i++) {
        double a[3], b[3], apex[3];
        problem *p = &problems[i];
        *p = empty_problem();
        direction(f, a);
        do
            direction(f, b);
        while (fabs(dot(a, b)) > 0.98);
        for (int k = 0; k < 3; k++)
            apex[k] = i % 2 ? between(f, 0, 1) : (double)(gpu_test_random(&f->random) % 2) * 0.96 + 0.02;
        for (int n = 0; n < 6; n++)
            add(f, p, apex, n % 3 ? a : b, true, 0);
    }
    const solution *got = solve(f, problems);
    for (int i = 0; i < COUNT; i++) {
        const problem *p = &problems[i];
        double lo[3], hi[3];
        oracle_qef oracle = oracle_of(p, lo, hi);
        assert_int_equal((int)got[i].rank, 2);
        bool inside = true;
        for (int k = 0; k < 3; k++)
            inside &= oracle.best[k] >= 0 && oracle.best[k] <= 1;
        ends += inside ? 0 : 1;
        for (uint32_t n = 0; n < p->planes; n++) {
            double off = 0;
            for (int k = 0; k < 3; k++)
                off += (double)p->values[n][1][k] * ((double)got[i].at[k] - (double)p->values[n][0][k]);
            worst = fmax(worst, fabs(off));
        }
    }
    print_message("# %d of %d lines nearest outside the cell; worst distance %.3g\n", ends, COUNT, worst);
    assert_true(ends > COUNT / 50 && worst < 5e-5);
}

/* --- what is no number -------------------------------------------------------------------------------------------- */

static void nothing_leaves_the_box(void **state)
{
    fixture *f = *state;
    const float odd[] = {NAN, INFINITY, -INFINITY, 0, 3e38f, 1e-45f, -1e30f, 1e25f};
    for (int i = 0; i < COUNT; i++) {
        problem *p = &problems[i];
        *p = i % 5 ? random_problem(f, 1 + i % 3, 0.1, 1) : empty_problem();
        for (int n = 0; n < i % 20; n++)
            (&p->values[0][0][0])[gpu_test_random(&f->random) % (6 * PLANES)] = odd[gpu_test_random(&f->random) % 8];
        if (i % 7 == 0)
            for (uint32_t n = 0; n < p->planes; n++)
                for (int k = 0; k < 3; k++)
                    p->values[n][i % 2][k] = odd[i % 8];
    }
    const solution *got = solve(f, problems);
    for (int i = 0; i < COUNT; i++)
        for (int k = 0; k < 3; k++)
            if (!(got[i].at[k] >= 0 && got[i].at[k] <= 1))
                fail_msg("problem %d: coordinate %d is %g", i, k, (double)got[i].at[k]);
    for (int k = 0; k < 3; k++)
        assert_true(got[0].at[k] == 0.5f && got[0].rank == 0);
}

#define BOTH(test)                                                                                                     \
    {#test "_by_device", test, by_device, NULL, NULL},                                                                 \
    {                                                                                                                  \
#test "_by_host", test, by_host, NULL, NULL                                                                    \
    }

int main(void)
{
    const struct CMUnitTest tests[] = {
        BOTH(random_planes_as_the_oracle), BOTH(flat_boxes),
        BOTH(corners_are_exact),           BOTH(edges_are_hit_within_the_cell),
        BOTH(nothing_leaves_the_box),
    };
    return cmocka_run_group_tests_name("qef", tests, open_fixture, close_fixture);
}
