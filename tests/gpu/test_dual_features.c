/* What dual contouring makes of sharp edges, corners and curved surfaces: cubes and wedges in random poses against
 * their planes, and distances from smooth surfaces against those of marching cubes. */
#include <math.h>

#include "test_dual_support.h"

/* --- a cube in a pose ----------------------------------------------------------------------------------------------
 */

enum { CELLS = 13 };
static const double half_side = 0.47;

typedef struct pose {
    double axis[3], angle, place[3];
    double turn[3][3]; /* columns are the cube's axes */
} pose;

static pose random_pose(uint64_t *random)
{
    pose p = {.angle = dual_between(random, 0.2, 3)};
    double size = 0;
    for (int k = 0; k < 3; k++) {
        p.axis[k] = dual_between(random, -1, 1);
        p.place[k] = dual_between(random, -0.1, 0.1);
        size += p.axis[k] * p.axis[k];
    }
    dual_turn(p.axis, p.angle, p.turn);
    return p;
}

static hewn_node posed(hewn_field *field, const pose *p, hewn_node shape)
{
    hewn_node turned = hewn_rotate(field, shape, p->axis[0], p->axis[1], p->axis[2], p->angle);
    return hewn_translate(field, turned, p->place[0], p->place[1], p->place[2]);
}

/* How far a point is above the cube's face 2 * axis + side. */
static double above(const pose *p, int face, const double at[3])
{
    double along = 0;
    for (int k = 0; k < 3; k++)
        along += p->turn[k][face / 2] * (at[k] - p->place[k]);
    return (face & 1 ? along : -along) - half_side;
}

/* Distance to the nearest of the cube's edges, or of its corners, that only the faces in the set bound. */
static double feature_distance(const pose *p, const double at[3], unsigned faces, int most_free)
{
    double along[3], least = INFINITY;
    for (int axis = 0; axis < 3; axis++) {
        along[axis] = 0;
        for (int k = 0; k < 3; k++)
            along[axis] += p->turn[k][axis] * (at[k] - p->place[k]);
    }
    for (int place = 0; place < 27; place++) {
        int side[3] = {place % 3, place / 3 % 3, place / 9}, free = 0; /* 0: low, 1: high, 2: anywhere between */
        double sum = 0;
        bool bound = true;
        for (int axis = 0; axis < 3; axis++) {
            double wanted = side[axis] == 2 ? fmin(fmax(along[axis], -half_side), half_side)
                            : side[axis]    ? half_side
                                            : -half_side;
            free += side[axis] == 2;
            bound &= side[axis] == 2 || (faces >> (2 * axis + side[axis]) & 1) != 0;
            sum += (along[axis] - wanted) * (along[axis] - wanted);
        }
        if (bound && free == most_free)
            least = fmin(least, sqrt(sum));
    }
    return least;
}

/* --- what a cell's edges see ---------------------------------------------------------------------------------------
 */

typedef struct sight {
    unsigned faces; /* of the cube that cross the cell's edges */
    bool doubtful;  /* a crossing is so near to another plane that either may be the one */
    bool in_parts;  /* may hold several vertices */
} sight;

static void sample(const struct hewn_grid *grid, const uint32_t cell[3], uint32_t corner, double at[3])
{
    for (int k = 0; k < 3; k++)
        at[k] = (double)grid->origin[k] + (double)grid->cell * (cell[k] + (corner >> k & 1));
}

/* The face through which a line from an inside sample to an outside one leaves the cube, and how much later it meets
 * the next one. */
static int face_left(const pose *p, const double inside[3], const double outside[3], double *lead)
{
    double first = INFINITY, second = INFINITY;
    int left = 0;
    for (int face = 0; face < 6; face++) {
        double a = above(p, face, inside), b = above(p, face, outside);
        if (b <= 0)
            continue;
        double t = a / (a - b);
        second = fmin(second, fmax(t, first));
        left = t < first ? face : left;
        first = fmin(first, t);
    }
    *lead = second - first;
    return left;
}

static sight look(const pose *p, const struct hewn_grid *grid, const uint32_t cell[3])
{
    sight seen = {0};
    double at[8][3];
    bool inside[8];
    unsigned pattern = 0;
    for (uint32_t corner = 0; corner < 8; corner++) {
        double most = -INFINITY;
        sample(grid, cell, corner, at[corner]);
        for (int face = 0; face < 6; face++)
            most = fmax(most, above(p, face, at[corner]));
        inside[corner] = most < 0;
        pattern |= inside[corner] ? 1u << corner : 0;
        seen.doubtful |= fabs(most) < 1e-5 * (double)grid->cell;
    }
    for (uint32_t edge = 0; edge < 12; edge++) {
        uint32_t from = hewn_cube_edge_start(edge), to = from | 1u << edge / 4;
        if (inside[from] == inside[to])
            continue;
        double lead;
        int face = inside[from] ? face_left(p, at[from], at[to], &lead) : face_left(p, at[to], at[from], &lead);
        seen.faces |= 1u << face;
        seen.doubtful |= lead < 1e-4;
    }
    seen.in_parts = dual_parts(pattern) > 1;
    return seen;
}

/* How much of the cube's edge between two faces lies in a cell, in cells. */
static double edge_inside(const pose *p, const struct hewn_grid *grid, const uint32_t cell[3], unsigned faces)
{
    double from[3], to[3] = {0}, begin = 0, end = 1;
    memcpy(from, p->place, sizeof from);
    for (int axis = 0; axis < 3; axis++) {
        unsigned sides = faces >> 2 * axis & 3;
        if (sides == 3)
            return 0; /* opposite faces have no edge */
        for (int k = 0; k < 3; k++) {
            from[k] += p->turn[k][axis] * (sides & 2 ? half_side : -half_side);
        }
    }
    for (int axis = 0; axis < 3; axis++)
        if (!(faces >> 2 * axis & 3))
            for (int k = 0; k < 3; k++)
                to[k] = 2 * half_side * p->turn[k][axis];
    for (int k = 0; k < 3; k++) {
        double low = (double)grid->origin[k] + (double)grid->cell * cell[k];
        double a = (low - from[k]) / to[k], b = (low + (double)grid->cell - from[k]) / to[k];
        begin = fmax(begin, fmin(a, b));
        end = fmin(end, fmax(a, b));
    }
    return fmax(0, end - begin) * 2 * half_side / (double)grid->cell;
}

/* --- tallies ---------------------------------------------------------------------------------------------------------
 */

typedef struct tally {
    int corners_seen, corners_recovered, corners_missed, corners_empty, doubtful;
    int edge_vertices, outside, outside_off;
    double worst_corner, worst_edge, worst_outside;
    uint64_t told_corners, told_edges, told_found, told_lost;
} tally;

static void count_corner(const pose *p, const struct hewn_grid *grid, const dual_mesh *mesh, int corner, tally *sums)
{
    double at[3];
    uint32_t cell[3];
    unsigned faces = 0;
    for (int k = 0; k < 3; k++) {
        at[k] = p->place[k];
        for (int axis = 0; axis < 3; axis++)
            at[k] += p->turn[k][axis] * (corner >> axis & 1 ? half_side : -half_side);
        cell[k] = (uint32_t)((at[k] - (double)grid->origin[k]) / (double)grid->cell);
        faces |= 1u << (2 * k + (corner >> k & 1));
    }
    sight seen = look(p, grid, cell);
    double nearest = dual_nearest(mesh, grid, cell, at);
    if (seen.doubtful) {
        sums->doubtful++;
    } else if ((seen.faces & faces) == faces) {
        sums->corners_seen++;
        sums->worst_corner = fmax(sums->worst_corner, nearest);
    } else if (nearest < 1e-4) {
        sums->corners_recovered++;
    } else if (seen.faces) {
        sums->corners_missed++;
    } else {
        sums->corners_empty++;
    }
}

static void count_vertex(const pose *p, const struct hewn_grid *grid, const float *position, tally *sums)
{
    double at[3];
    uint32_t cell[3];
    for (int k = 0; k < 3; k++) {
        at[k] = (double)position[k];
        cell[k] = (uint32_t)((at[k] - (double)grid->origin[k]) / (double)grid->cell);
    }
    sight seen = look(p, grid, cell);
    int faces = __builtin_popcount(seen.faces);
    if (seen.doubtful || seen.in_parts || faces < 2)
        return;
    bool through = faces == 2 && edge_inside(p, grid, cell, seen.faces) > 1e-3;
    double off = feature_distance(p, at, through ? seen.faces : 63u, 1) / (double)grid->cell;
    if (through) {
        sums->edge_vertices++;
        sums->worst_edge = fmax(sums->worst_edge, off);
    } else {
        sums->outside++;
        sums->outside_off += off > 1e-4 ? 1 : 0;
        sums->worst_outside = fmax(sums->worst_outside, off);
    }
}

static void check_pose(dual_subject *subject, const pose *p, tally *sums)
{
    hewn_extract_stats stats;
    dual_mesh mesh = dual_extract(subject, CELLS, HEWN_METHOD_DC, &stats);
    struct hewn_grid grid = mesh.grid;
    for (int corner = 0; corner < 8; corner++)
        count_corner(p, &grid, &mesh, corner, sums);
    for (uint64_t i = 0; i < mesh.triangles.vertex_count - stats.fans; i++)
        count_vertex(p, &grid, mesh.triangles.positions + 3 * i, sums);
    sums->told_corners += stats.corner_vertices;
    sums->told_edges += stats.edge_vertices;
    sums->told_found += stats.planes_found;
    sums->told_lost += stats.features_lost;
    hewn_triangles_destroy(&mesh.triangles);
}

static hewn_node make_cube(hewn_field *field, const void *user)
{
    return posed(field, user, hewn_box_shape(field, 2 * half_side, 2 * half_side, 2 * half_side));
}

static void cubes_keep_edges_and_corners(void **state)
{
    dual_fixture *f = *state;
    uint64_t random = 4711;
    tally sums = {0};
    pose first = random_pose(&random);
    dual_subject subject = dual_make(f, make_cube, &first);
    int poses = gpu_test_long() ? 1000 : 100;
    for (int i = 0; i < poses; i++) {
        pose p = random_pose(&random);
        dual_renumber(&subject, make_cube, &p);
        check_pose(&subject, &p, &sums);
    }
    dual_free(&subject);
    print_message(
        "# %d corners: %d seen (worst %.2g of a cell), %d recovered, %d missed, %d in cells without crossings, %d "
        "doubtful\n",
        8 * poses, sums.corners_seen, sums.worst_corner, sums.corners_recovered, sums.corners_missed,
        sums.corners_empty, sums.doubtful);
    print_message(
        "# %d vertices in cells with two faces and their edge (worst %.2g); %d with more faces or an edge that "
        "passes by, %d of them off all edges (worst %.2g)\n",
        sums.edge_vertices, sums.worst_edge, sums.outside, sums.outside_off, sums.worst_outside);
    print_message("# told: %llu corners, %llu on edges, %llu planes found, %llu lost\n",
                  (unsigned long long)sums.told_corners, (unsigned long long)sums.told_edges,
                  (unsigned long long)sums.told_found, (unsigned long long)sums.told_lost);
    assert_true(sums.corners_seen > 3 * poses && sums.worst_corner <= 1e-4);
    assert_true(sums.edge_vertices > 50 * poses && sums.worst_edge <= 1e-4);
}

/* --- curved surfaces ------------------------------------------------------------------------------------------------
 */

static hewn_node make_sphere(hewn_field *field, const void *user)
{
    (void)user;
    return hewn_translate(field, hewn_sphere(field, 0.8), 0.013, -0.021, 0.007);
}

static hewn_node make_torus(hewn_field *field, const void *user)
{
    (void)user;
    return hewn_rotate(field, hewn_torus(field, 0.6, 0.25), 1, 2, 3, 0.5);
}

static hewn_node make_gyroid(hewn_field *field, const void *user)
{
    (void)user;
    hewn_node x = hewn_x(field), y = hewn_y(field), z = hewn_z(field), k = hewn_constant(field, 5);
    hewn_node a = hewn_mul(field, hewn_sin(field, hewn_mul(field, k, x)), hewn_cos(field, hewn_mul(field, k, y)));
    hewn_node b = hewn_mul(field, hewn_sin(field, hewn_mul(field, k, y)), hewn_cos(field, hewn_mul(field, k, z)));
    hewn_node c = hewn_mul(field, hewn_sin(field, hewn_mul(field, k, z)), hewn_cos(field, hewn_mul(field, k, x)));
    return hewn_add(field, hewn_add(field, a, b), c);
}

static hewn_node make_melted(hewn_field *field, const void *user)
{
    (void)user;
    hewn_node ring = hewn_rotate(field, hewn_torus(field, 0.55, 0.17), 1, 2, 0.5, 0.7);
    hewn_node peg = hewn_rotate(field, hewn_capsule(field, 0.2, 0.9), 0, 0, 1, 1.1);
    hewn_node both = hewn_smooth_union(field, ring, peg, HEWN_BLEND_CUBIC, 0.25);
    return hewn_smooth_difference(field, both, hewn_translate(field, hewn_sphere(field, 0.3), 0.1, 0.3, 0.4),
                                  HEWN_BLEND_CUBIC, 0.2);
}

static void curved_surfaces_are_no_farther_than_by_mc(void **state)
{
    dual_fixture *f = *state;
    static const struct {
        const char *name;
        dual_maker *make;
    } shapes[] = {{"sphere", make_sphere}, {"torus", make_torus}, {"gyroid", make_gyroid}, {"melted", make_melted}};
    static const uint32_t resolutions[] = {16, 32, 64};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        dual_subject subject = dual_make(f, shapes[i].make, NULL);
        for (size_t r = 0; r < sizeof resolutions / sizeof *resolutions; r++) {
            dual_distance of[3];
            static const hewn_method methods[] = {HEWN_METHOD_MARCHING_CUBES, HEWN_METHOD_NETS, HEWN_METHOD_DC};
            for (int m = 0; m < 3; m++) {
                hewn_extract_stats stats;
                dual_mesh mesh = dual_extract(&subject, resolutions[r], methods[m], &stats);
                of[m] = dual_measure(&subject, &mesh, 60000);
                if (m == 2)
                    print_message("# %u: %llu edges, %llu corners, %llu planes, %llu lost\n", resolutions[r],
                                  (unsigned long long)stats.edge_vertices, (unsigned long long)stats.corner_vertices,
                                  (unsigned long long)stats.planes_found, (unsigned long long)stats.features_lost);
                hewn_triangles_destroy(&mesh.triangles);
            }
            print_message("# %s, %u cells: mean %.3e %.3e %.3e, most %.3e %.3e %.3e (mc, nets, dc; in cells)\n",
                          shapes[i].name, resolutions[r], of[0].mean, of[1].mean, of[2].mean, of[0].most, of[1].most,
                          of[2].most);
            if (of[2].mean > of[0].mean || of[2].most > of[0].most)
                print_message("# ^ WORSE\n");
        }
        dual_free(&subject);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cubes_keep_edges_and_corners),
        cmocka_unit_test(curved_surfaces_are_no_farther_than_by_mc),
    };
    return cmocka_run_group_tests_name("dual_features", tests, dual_open, dual_close);
}
