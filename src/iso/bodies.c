/* Bodies and cavities. Which shell lies in which, the lattice says, not geometry: going along a row of samples, the
 * surface is crossed where the signs change, and between two crossings nothing else can lie. So on the left of the
 * leftmost crossing of a shell is what surrounds it; if that sample is outside, the shell is the hull of a body, if it
 * is inside, a cavity's wall. And the crossing before it on its row tells which region that is: the inside of that
 * shell, or what surrounds it. Every shell crosses an edge along i, as a sample that it encloses has the rim on its
 * left. */
#include "iso/bodies.h"

#include <stdlib.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/order.h"
#include "iso/lattice_blocks.h"

#define NONE 0xFFFFFFFFu

typedef struct shell {
    uint32_t leftmost; /* place along i of its leftmost crossing; NONE: not met yet */
    uint32_t before;   /* the shell of the crossing before that, on the same row; NONE: there is none */
    uint32_t parent;   /* the shell whose inside surrounds this one; NONE: nothing does */
    bool cavity, kept;
    double volume; /* enclosed, less that of cavities directly in it */
} shell;

typedef struct bodies {
    const hewn_lattice *lattice;
    hewn_triangles *mesh;
    uint32_t *of; /* the shell of each vertex */
    shell *shells;
    uint32_t *order; /* shells by their leftmost crossing; then bodies by volume */
    uint32_t count;
} bodies;

/* --- shells ------------------------------------------------------------------------------------------------------- */

static uint32_t find_root(uint32_t *parent, uint32_t v)
{
    while (parent[v] != v) {
        parent[v] = parent[parent[v]];
        v = parent[v];
    }
    return v;
}

/* Roots are the lowest vertices of their shells, so shells are numbered in the order of these. */
static hewn_result find_shells(bodies *found, hewn_error *error)
{
    const hewn_triangles *mesh = found->mesh;
    uint32_t vertices = (uint32_t)mesh->vertex_count;
    found->of = hewn_alloc(vertices, sizeof *found->of);
    if (!found->of)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the bodies of a mesh");
    for (uint32_t v = 0; v < vertices; v++)
        found->of[v] = v;
    for (uint64_t c = 0; c < 3 * mesh->triangle_count; c += 3)
        for (uint64_t other = c + 1; other < c + 3; other++) {
            uint32_t a = find_root(found->of, mesh->indices[c]), b = find_root(found->of, mesh->indices[other]);
            found->of[a > b ? a : b] = a > b ? b : a;
        }
    for (uint32_t v = 0; v < vertices; v++) /* what a vertex points to has its number already: it is lower */
        found->of[v] = found->of[v] == v ? found->count++ : found->of[found->of[v]];
    found->shells = hewn_alloc_zero(found->count, sizeof *found->shells);
    found->order = hewn_alloc(found->count, sizeof *found->order);
    if (!found->shells || !found->order)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %u shells of a mesh", found->count);
    for (uint32_t s = 0; s < found->count; s++)
        found->shells[s] = (shell){.leftmost = NONE, .before = NONE, .parent = NONE, .kept = true};
    return HEWN_OK;
}

/* --- which lies in which ------------------------------------------------------------------------------------------ */

/* The shell of a crossing: that of its vertex, by dual methods that of its quad. */
static uint32_t shell_of(const bodies *found, uint64_t crossing)
{
    return found->of[found->lattice->dual ? found->mesh->indices[6 * crossing] : crossing];
}

/* A crossing of a row at a place along i; `before` is the shell of the one before it, and then this one's. `inside`:
 * the sample there is. */
static void meet(bodies *found, uint32_t at, uint32_t crossing, bool inside, uint32_t *before)
{
    uint32_t number = shell_of(found, crossing);
    shell *here = &found->shells[number];
    if (at < here->leftmost) {
        here->leftmost = at;
        here->before = *before;
        here->cavity = inside;
    }
    *before = number;
}

static void walk_row(bodies *found, uint32_t j, uint32_t k)
{
    const hewn_lattice *lattice = found->lattice;
    const uint64_t *bits = hewn_lattice_bits(lattice, j, k);
    uint32_t vertex = hewn_lattice_row_at(lattice, j, k)->vertices[0], before = NONE;
    for (uint32_t word = 0; word < lattice->words; word++) {
        uint64_t rest = bits[word] ^ hewn_lattice_next(bits, word);
        for (rest &= hewn_lattice_mask(word, lattice->dims[0] - 1); rest; rest &= rest - 1) {
            uint32_t bit = hewn_lattice_lowest(rest);
            meet(found, 64 * word + bit, vertex++, bits[word] >> bit & 1, &before);
        }
    }
}

/* Where samples are in blocks: the rows of slice z of the blocks of a bar. */
static void walk_bar(bodies *found, uint64_t first, uint64_t end, uint32_t z)
{
    const hewn_lattice *lattice = found->lattice;
    const hewn_lattice_blocks *blocks = lattice->blocks;
    uint32_t before[HEWN_BLOCK];
    for (uint32_t y = 0; y < HEWN_BLOCK; y++)
        before[y] = NONE;
    for (uint64_t block = first; block < end; block++) {
        hewn_block_signs signs;
        uint32_t start[3];
        hewn_block_signs_load(lattice, blocks->surface[block].place, &signs);
        hewn_block_start(lattice, blocks->surface[block].place, start);
        uint64_t rest = hewn_block_crossed(&signs, 0, z);
        for (uint32_t y = 0; y < HEWN_BLOCK; y++) {
            uint32_t vertex = hewn_block_row(blocks, block, y, z)->vertices[0];
            for (uint32_t row = rest >> HEWN_BLOCK * y & 0xFF; row; row &= row - 1) {
                uint32_t bit = hewn_lattice_lowest(row);
                bool inside = signs.here[z] >> (bit + HEWN_BLOCK * y) & 1;
                meet(found, start[0] + bit, vertex++, inside, &before[y]);
            }
        }
    }
}

/* In the order of rows, as others are walked. */
static void walk_blocks(bodies *found)
{
    const hewn_lattice_blocks *blocks = found->lattice->blocks;
    for (uint64_t layer = 0, end; layer < blocks->count; layer = end) {
        end = hewn_block_layer_end(blocks, layer, blocks->count);
        for (uint32_t z = 0; z < HEWN_BLOCK; z++)
            for (uint64_t bar = layer, next; bar < end; bar = next) {
                next = hewn_block_bar_end(blocks, bar, end);
                walk_bar(found, bar, next, z);
            }
    }
}

static hewn_result sort_by_leftmost(bodies *found, hewn_error *error)
{
    uint64_t *keys = hewn_alloc(found->count, sizeof *keys);
    if (!keys)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %u shells of a mesh", found->count);
    for (uint32_t s = 0; s < found->count; s++)
        keys[s] = (uint64_t)found->shells[s].leftmost << 32 | s;
    qsort(keys, found->count, sizeof *keys, hewn_order_uint64);
    for (uint32_t s = 0; s < found->count; s++)
        found->order[s] = (uint32_t)keys[s];
    hewn_free(keys);
    return HEWN_OK;
}

/* The crossing before a shell's leftmost one is of a shell that begins further left, so its parent is known. The two
 * have a region in common: that in which the shell lies. It is inside of the one before if that is the wall of what the
 * region is made of. */
static hewn_result find_parents(bodies *found, hewn_error *error)
{
    for (uint32_t k = 0; k < found->lattice->dims[2] && !found->lattice->blocks; k++)
        for (uint32_t j = 0; j < found->lattice->dims[1]; j++)
            walk_row(found, j, k);
    if (found->lattice->blocks)
        walk_blocks(found);
    HEWN_TRY(sort_by_leftmost(found, error));
    for (uint32_t n = 0; n < found->count; n++) {
        shell *here = &found->shells[found->order[n]];
        if (here->before == NONE)
            continue;
        const shell *before = &found->shells[here->before];
        here->parent = before->cavity != here->cavity ? here->before : before->parent;
    }
    return HEWN_OK;
}

/* --- how large ---------------------------------------------------------------------------------------------------- */

/* Six times the volume of the pyramid over a triangle, seen from a vertex of its own shell, so that what is far away
 * from the origin keeps its digits. */
static double pyramid(const hewn_triangles *mesh, const uint32_t corners[3], const float *apex)
{
    double p[3][3];
    for (int c = 0; c < 3; c++)
        for (int axis = 0; axis < 3; axis++)
            p[c][axis] = (double)mesh->positions[3 * (size_t)corners[c] + (size_t)axis] - (double)apex[axis];
    return p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) + p[0][1] * (p[1][2] * p[2][0] - p[1][0] * p[2][2]) +
           p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]);
}

static hewn_result measure(bodies *found, hewn_error *error)
{
    const hewn_triangles *mesh = found->mesh;
    uint32_t *apex = hewn_alloc(found->count, sizeof *apex);
    if (!apex)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %u shells of a mesh", found->count);
    for (uint64_t v = mesh->vertex_count; v-- > 0;)
        apex[found->of[v]] = (uint32_t)v;
    for (uint64_t c = 0; c < 3 * mesh->triangle_count; c += 3) {
        uint32_t number = found->of[mesh->indices[c]];
        found->shells[number].volume +=
            pyramid(mesh, mesh->indices + c, mesh->positions + 3 * (size_t)apex[number]) / 6;
    }
    hewn_free(apex);
    for (uint32_t s = 0; s < found->count; s++) /* walls of cavities have a volume below 0 */
        if (found->shells[s].cavity)
            found->shells[found->shells[s].parent].volume += found->shells[s].volume;
    return HEWN_OK;
}

/* --- choosing ----------------------------------------------------------------------------------------------------- */

typedef struct ranked {
    double volume;
    uint32_t number;
} ranked;

static int by_volume(const void *a, const void *b)
{
    const ranked *x = a, *y = b;
    if (x->volume != y->volume)
        return x->volume < y->volume ? 1 : -1;
    return (x->number > y->number) - (x->number < y->number);
}

static hewn_result keep_largest(bodies *found, uint64_t wanted, hewn_error *error)
{
    ranked *all = hewn_alloc(found->count, sizeof *all);
    uint32_t count = 0;
    if (!all)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %u shells of a mesh", found->count);
    for (uint32_t s = 0; s < found->count; s++)
        if (!found->shells[s].cavity)
            all[count++] = (ranked){found->shells[s].volume, s};
    qsort(all, count, sizeof *all, by_volume);
    for (uint64_t n = wanted; n < count; n++)
        found->shells[all[n].number].kept = false;
    hewn_free(all);
    return HEWN_OK;
}

/* From the outside to the inside: `order` has what surrounds a shell before it. A filled cavity swallows the bodies in
 * it; a body that is not kept takes its cavities along, but not what lies in these. */
static void fill(bodies *found, bool fill_cavities)
{
    for (uint32_t n = 0; n < found->count; n++) {
        uint32_t number = found->order[n];
        shell *here = &found->shells[number];
        if (here->cavity) {
            here->kept = found->shells[here->parent].kept && !fill_cavities;
            continue;
        }
        for (uint32_t up = here->parent; fill_cavities && here->kept && up != NONE; up = found->shells[up].parent)
            here->kept = found->shells[up].cavity || !found->shells[up].kept;
    }
}

static hewn_result choose(bodies *found, const hewn_body_choice *choice, hewn_body_counts *counts, hewn_error *error)
{
    double most = 0;
    for (uint32_t s = 0; s < found->count; s++) {
        const shell *here = &found->shells[s];
        counts->bodies += !here->cavity;
        counts->cavities += here->cavity;
        most = !here->cavity && here->volume > most ? here->volume : most;
    }
    if (choice->largest > 0)
        HEWN_TRY(keep_largest(found, choice->largest, error));
    for (uint32_t s = 0; s < found->count && choice->least_volume > 0; s++)
        if (!found->shells[s].cavity && found->shells[s].volume < choice->least_volume)
            found->shells[s].kept = false;
    fill(found, choice->fill_cavities);
    for (uint32_t s = 0; s < found->count; s++) {
        counts->kept_bodies += found->shells[s].kept && !found->shells[s].cavity;
        counts->kept_cavities += found->shells[s].kept && found->shells[s].cavity;
    }
    counts->largest_volume = most;
    if (counts->kept_bodies > 0)
        return HEWN_OK;
    return hewn_fail(error, HEWN_BAD_INPUT, "none of the %llu bodies is as large as that: the largest has %.6g",
                     (unsigned long long)counts->bodies, most);
}

/* --- what is left ------------------------------------------------------------------------------------------------- */

static bool is_kept(const bodies *found, uint64_t vertex)
{
    return found->shells[found->of[vertex]].kept;
}

static bool is_crossing_kept(const bodies *found, uint64_t crossing)
{
    return found->shells[shell_of(found, crossing)].kept;
}

static uint64_t count_kept(const bodies *found, uint64_t begin, uint64_t end)
{
    uint64_t count = 0;
    for (uint64_t v = begin; v < end; v++)
        count += is_crossing_kept(found, v);
    return count;
}

/* As lattice_count.c counts them: on the edges of a row that begin or end in the rim. */
static uint64_t count_caps(const bodies *found)
{
    const hewn_lattice *lattice = found->lattice;
    uint64_t count = 0, rows = (uint64_t)lattice->dims[1] * lattice->dims[2];
    for (uint64_t n = 0; n < rows; n++) {
        uint32_t j = (uint32_t)(n % lattice->dims[1]), k = (uint32_t)(n / lattice->dims[1]);
        const hewn_lattice_row *row = &lattice->rows[n];
        const uint64_t *bits = hewn_lattice_bits(lattice, j, k);
        uint64_t end = n + 1 < rows ? row[1].vertices[0] : lattice->vertex_count;
        uint32_t last = lattice->dims[0] - 2;
        if (bits[0] >> 1 & 1)
            count += is_crossing_kept(found, row->vertices[0]);
        if (bits[last / 64] >> last % 64 & 1)
            count += is_crossing_kept(found, row->vertices[1] - 1);
        if (hewn_lattice_in_rim(lattice, 1, j) || hewn_lattice_in_rim(lattice, 1, j + 1))
            count += count_kept(found, row->vertices[1], row->vertices[2]);
        if (hewn_lattice_in_rim(lattice, 2, k) || hewn_lattice_in_rim(lattice, 2, k + 1))
            count += count_kept(found, row->vertices[2], end);
    }
    return count;
}

/* The same where samples are in blocks. */
static uint64_t count_block_caps(const bodies *found)
{
    const hewn_lattice *lattice = found->lattice;
    uint64_t count = 0;
    for (uint64_t block = 0; block < lattice->blocks->count; block++) {
        hewn_block_signs signs;
        hewn_block_signs_load(lattice, lattice->blocks->surface[block].place, &signs);
        for (uint32_t n = 0; n < 3 * HEWN_BLOCK_ROWS; n++) {
            const uint32_t axis = n % 3, y = n / 3 % HEWN_BLOCK, z = n / 3 / HEWN_BLOCK;
            const uint64_t row = (uint64_t)0xFF << HEWN_BLOCK * y;
            const uint64_t crossed = hewn_block_crossed(&signs, axis, z) & row;
            const uint64_t caps = hewn_block_rim_edges(lattice, block, axis, z);
            uint32_t vertex = hewn_block_row(lattice->blocks, block, y, z)->vertices[axis];
            for (uint64_t rest = crossed; rest; rest &= rest - 1, vertex++)
                count += caps >> hewn_lattice_lowest(rest) & 1 && is_crossing_kept(found, vertex);
        }
    }
    return count;
}

/* Moves together what stays, in its order; the numbers of vertices end up in `of`. */
static void compact(bodies *found)
{
    hewn_triangles *mesh = found->mesh;
    uint64_t triangles = 0, vertices = 0;
    for (uint64_t c = 0; c < 3 * mesh->triangle_count; c += 3)
        if (is_kept(found, mesh->indices[c])) {
            for (int i = 0; i < 3; i++)
                mesh->indices[3 * triangles + (uint64_t)i] = mesh->indices[c + (uint64_t)i];
            triangles++;
        }
    for (uint64_t v = 0; v < mesh->vertex_count; v++) {
        bool stays = is_kept(found, v);
        found->of[v] = stays ? (uint32_t)vertices : NONE;
        for (uint64_t i = 0; stays && i < 3; i++) {
            mesh->positions[3 * vertices + i] = mesh->positions[3 * v + i];
            if (mesh->normals)
                mesh->normals[3 * vertices + i] = mesh->normals[3 * v + i];
        }
        vertices += stays;
    }
    for (uint64_t c = 0; c < 3 * triangles; c++)
        mesh->indices[c] = found->of[mesh->indices[c]];
    mesh->triangle_count = triangles;
    mesh->vertex_count = vertices;
}

static hewn_result run(bodies *found, hewn_lattice *lattice, const hewn_body_choice *choice, hewn_body_counts *counts,
                       hewn_error *error)
{
    HEWN_TRY(find_shells(found, error));
    HEWN_TRY(find_parents(found, error));
    HEWN_TRY(measure(found, error));
    HEWN_TRY(choose(found, choice, counts, error));
    if (counts->kept_bodies + counts->kept_cavities == found->count)
        return HEWN_OK;
    lattice->cap_vertices = lattice->blocks ? count_block_caps(found) : count_caps(found);
    compact(found);
    return HEWN_OK;
}

hewn_result hewn_lattice_choose_bodies(hewn_lattice *lattice, const hewn_body_choice *choice, hewn_triangles *mesh,
                                       hewn_body_counts *counts, hewn_error *error)
{
    bodies found = {.lattice = lattice, .mesh = mesh};
    *counts = (hewn_body_counts){0};
    hewn_result result = run(&found, lattice, choice, counts, error);
    hewn_free(found.of);
    hewn_free(found.shells);
    hewn_free(found.order);
    return result;
}
