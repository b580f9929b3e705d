/* What dual contouring makes of sharp edges, corners and curved surfaces: cubes and wedges in random poses against
 * their planes, and distances from smooth surfaces against those of marching cubes. */
#include <math.h>

#include "test_code_support.h"
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
    for (int k = 0; k < 3; k++) {
        p.axis[k] = dual_between(random, -1, 1);
        p.place[k] = dual_between(random, -0.1, 0.1);
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
    int corners = sums.corners_seen + sums.corners_recovered;
    assert_true(sums.corners_missed == 0 && 4 * corners > 3 * 8 * poses);
    assert_true(labs((long)sums.told_corners - corners) <= sums.doubtful);
    assert_true(sums.told_edges >= (uint64_t)sums.edge_vertices - sums.told_corners && sums.told_found > 0);
    assert_true(sums.told_lost * 2 >= (uint64_t)(sums.corners_empty));
    assert_true(sums.edge_vertices > 50 * poses && sums.worst_edge <= 1e-4);
}

/* --- wedges --------------------------------------------------------------------------------------------------------
 */

typedef struct wedge {
    double normal[2][3], distance[2];
    double point[3], along[3]; /* the edge */
    bool hollow;
} wedge;

static wedge random_wedge(uint64_t *random, double angle, bool hollow)
{
    wedge w = {.hollow = hollow};
    double axis[3], turn[3][3], size;
    for (int k = 0; k < 3; k++) {
        axis[k] = dual_between(random, -1, 1);
        w.point[k] = dual_between(random, -0.2, 0.2);
    }
    size = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    dual_turn(axis, dual_between(random, 0.2, 3), turn);
    for (int k = 0; k < 3; k++) {
        w.along[k] = turn[k][2];
        w.normal[0][k] = turn[k][0];
        w.normal[1][k] = cos(angle) * turn[k][0] + sin(angle) * turn[k][1];
        for (int side = 0; side < 2; side++)
            w.distance[side] += w.normal[side][k] * w.point[k];
    }
    assert_true(size > 0);
    return w;
}

static hewn_node make_wedge(hewn_field *field, const void *user)
{
    const wedge *w = user;
    hewn_node side[2];
    for (int i = 0; i < 2; i++)
        side[i] = hewn_plane(field, w->normal[i][0], w->normal[i][1], w->normal[i][2], w->distance[i]);
    return w->hollow ? hewn_union(field, side[0], side[1]) : hewn_intersection(field, side[0], side[1]);
}

/* How far a vertex is off the edge, in cells, if the edge passes through its cell, well within the bounds; else 0. */
static double wedge_distance(const wedge *w, const struct hewn_grid *grid, const float *position)
{
    double begin = -10, end = 10, off[3], along = 0, sum = 0;
    for (int k = 0; k < 3; k++) {
        double low = floor(((double)position[k] - (double)grid->origin[k]) / (double)grid->cell);
        low = low * (double)grid->cell + (double)grid->origin[k];
        double a = (low - w->point[k]) / w->along[k], b = (low + (double)grid->cell - w->point[k]) / w->along[k];
        begin = fmax(begin, fmin(a, b));
        end = fmin(end, fmax(a, b));
        off[k] = (double)position[k] - w->point[k];
        along += off[k] * w->along[k];
        if (fabs((double)position[k]) > 1 - 2 * (double)grid->cell)
            return 0;
    }
    for (int k = 0; k < 3; k++)
        sum += (off[k] - along * w->along[k]) * (off[k] - along * w->along[k]);
    return end - begin > 1e-3 * (double)grid->cell ? sqrt(sum) / (double)grid->cell : 0;
}

/* Where the edge of two planes passes through a cell with a vertex, blunt or acute, solid or hollow, the vertex is on
 * it: but for loops that share a cell, and where one of the planes crosses none of the cell's edges. */
static void wedges_keep_their_edge(void **state)
{
    dual_fixture *f = *state;
    static const double degrees[] = {8, 20, 45, 90, 120, 150};
    uint64_t random = 77;
    for (int hollow = 0; hollow < 2; hollow++) {
        wedge w = random_wedge(&random, 1, hollow);
        dual_subject subject = dual_make(f, make_wedge, &w);
        for (size_t i = 0; i < sizeof degrees / sizeof *degrees; i++) {
            uint64_t near = 0, off = 0;
            double most = 0;
            for (int pose_of = 0; pose_of < (gpu_test_long() ? 100 : 10); pose_of++) {
                hewn_extract_stats stats;
                w = random_wedge(&random, degrees[i] * acos(-1) / 180, hollow);
                dual_renumber(&subject, make_wedge, &w);
                dual_mesh mesh = dual_extract(&subject, CELLS, HEWN_METHOD_DC, &stats);
                for (uint64_t v = 0; v < mesh.triangles.vertex_count - stats.fans; v++) {
                    double distance = wedge_distance(&w, &mesh.grid, mesh.triangles.positions + 3 * v);
                    near += distance > 0 && distance <= 1e-4 ? 1 : 0;
                    off += distance > 1e-4 ? 1 : 0;
                    most = fmax(most, distance);
                }
                hewn_triangles_destroy(&mesh.triangles);
            }
            print_message("# %s wedge, %g degrees between normals: %llu vertices on the edge, %llu off (most %.2g)\n",
                          hollow ? "hollow" : "solid", degrees[i], (unsigned long long)near, (unsigned long long)off,
                          most);
            assert_true(near > 20 && (degrees[i] > 90 ? off * 10 < near : off == 0));
        }
        dual_free(&subject);
    }
}

/* --- cones -------------------------------------------------------------------------------------------------------- */

static hewn_node make_cone(hewn_field *field, const void *user)
{
    return posed(field, user, hewn_cone(field, 0.5, 0, 0.9));
}

static void cones_keep_their_tip(void **state)
{
    dual_fixture *f = *state;
    uint64_t random = 3;
    pose p = random_pose(&random);
    dual_subject subject = dual_make(f, make_cone, &p);
    int on_tip = 0, poses = gpu_test_long() ? 400 : 40;
    for (int i = 0; i < poses; i++) {
        hewn_extract_stats stats;
        double tip[3], least = INFINITY;
        p = random_pose(&random);
        dual_renumber(&subject, make_cone, &p);
        dual_mesh mesh = dual_extract(&subject, 16, HEWN_METHOD_DC, &stats);
        for (int k = 0; k < 3; k++)
            tip[k] = p.place[k] + 0.45 * p.turn[k][1];
        for (uint64_t v = 0; v < mesh.triangles.vertex_count; v++) {
            double sum = 0;
            for (int k = 0; k < 3; k++) {
                double off = (double)mesh.triangles.positions[3 * v + (uint64_t)k] - tip[k];
                sum += off * off;
            }
            least = fmin(least, sqrt(sum) / (double)mesh.grid.cell);
        }
        on_tip += least <= 1e-3 ? 1 : 0;
        hewn_triangles_destroy(&mesh.triangles);
    }
    dual_free(&subject);
    print_message("# a vertex on the tip of %d cones of %d\n", on_tip, poses);
    assert_true(3 * on_tip > poses);
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
                hewn_triangles_destroy(&mesh.triangles);
            }
            print_message("# %s, %u cells: mean %.3e %.3e %.3e, most %.3e %.3e %.3e (mc, nets, dc; in cells)\n",
                          shapes[i].name, resolutions[r], of[0].mean, of[1].mean, of[2].mean, of[0].most, of[1].most,
                          of[2].most);
            assert_true(of[2].mean <= of[0].mean && of[2].most <= of[0].most);
        }
        dual_free(&subject);
    }
}

/* --- triangles that meet others ---------------------------------------------------------------------------------- */

static hewn_node make_tree(hewn_field *field, const void *user)
{
    uint64_t random = 1 + *(const uint64_t *)user;
    return code_many_shapes(field, &random, 12);
}

static void few_triangles_meet_others(void **state)
{
    dual_fixture *f = *state;
    static const hewn_method methods[] = {HEWN_METHOD_NETS, HEWN_METHOD_DC};
    static const uint32_t resolutions[] = {24, 64};
    uint64_t trees = gpu_test_long() ? 60 : 6, triangles[2] = {0}, pairs[2] = {0}, meshes[2] = {0}, fans[2] = {0};
    for (uint64_t seed = 0; seed < trees; seed++) {
        dual_subject subject = dual_make(f, make_tree, &seed);
        for (int i = 0; i < 4; i++) {
            hewn_extract_stats stats;
            uint64_t count = 0;
            int m = i % 2;
            dual_mesh mesh = dual_extract(&subject, resolutions[i / 2], methods[m], &stats);
            GPU_TEST_TRY(hewn_triangles_count_self_intersections(&mesh.triangles, 0, NULL, NULL, &count, &error));
            triangles[m] += mesh.triangles.triangle_count;
            pairs[m] += count;
            meshes[m] += count > 0 ? 1 : 0;
            fans[m] += stats.fans;
            hewn_triangles_destroy(&mesh.triangles);
        }
        dual_free(&subject);
    }
    for (int m = 0; m < 2; m++) {
        print_message("# %s: %llu pairs in %llu meshes of %llu, %llu triangles, %llu fans\n",
                      hewn_method_name(methods[m]), (unsigned long long)pairs[m], (unsigned long long)meshes[m],
                      (unsigned long long)(2 * trees), (unsigned long long)triangles[m], (unsigned long long)fans[m]);
        assert_true(pairs[m] * 2000 <= triangles[m]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cubes_keep_edges_and_corners),
        cmocka_unit_test(wedges_keep_their_edge),
        cmocka_unit_test(cones_keep_their_tip),
        cmocka_unit_test(few_triangles_meet_others),
        cmocka_unit_test(curved_surfaces_are_no_farther_than_by_mc),
    };
    return cmocka_run_group_tests_name("dual_features", tests, dual_open, dual_close);
}
