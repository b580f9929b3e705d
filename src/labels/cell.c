#include "labels/cell.h"

#include <string.h>

#include "base/alloc.h"

/* u and v of the axis after: corners low, + u, + u + v, + v. Corners of the other side have no place. */
const uint8_t hewn_cell_order[6][8] = {
    {0, 0, 1, 1, 3, 3, 2, 2}, {0, 0, 1, 1, 3, 3, 2, 2}, /* across i: u = j, v = k */
    {0, 3, 0, 3, 1, 2, 1, 2}, {0, 3, 0, 3, 1, 2, 1, 2}, /* across j: u = k, v = i */
    {0, 1, 3, 2, 0, 1, 3, 2}, {0, 1, 3, 2, 0, 1, 3, 2}, /* across k: u = i, v = j */
};

/* Around the arc the cells follow each other as (+u, +v), (-u, +v), (-u, -v), (+u, -v); in the first the arc is at the
 * low end of both axes. */
#define ARCS_ALONG(axis, u, v)                                                                                         \
    {0, axis, 2 * (v), 2 * (u)}, {1 << (u), axis, 2 * (u) + 1, 2 * (v)}, {1 << (v), axis, 2 * (u), 2 * (v) + 1},       \
    {                                                                                                                  \
        1 << (u) | 1 << (v), axis, 2 * (v) + 1, 2 * (u) + 1                                                            \
    }
const hewn_cell_arc hewn_cell_arcs[12] = {ARCS_ALONG(0, 1, 2), ARCS_ALONG(1, 2, 0), ARCS_ALONG(2, 0, 1)};

static unsigned face_corner(unsigned face, unsigned order)
{
    unsigned axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
    return (face & 1) << axis | (order == 1 || order == 2 ? 1u << u : 0) | (order >= 2 ? 1u << v : 0);
}

uint32_t hewn_cell_key(const uint16_t labels[8])
{
    uint16_t known[8] = {labels[0]};
    unsigned count = 1;
    uint32_t key = 0;
    for (unsigned corner = 1; corner < 8; corner++) {
        unsigned class = 0;
        while (class < count && known[class] != labels[corner])
            class ++;
        if (class == count)
            known[count++] = labels[corner];
        key |= class << (3 * corner - 3);
    }
    for (unsigned face = 0; face < 6; face++) {
        uint16_t a = labels[face_corner(face, 0)], b = labels[face_corner(face, 1)];
        bool both = a != b && a == labels[face_corner(face, 2)] && b == labels[face_corner(face, 3)];
        key |= (uint32_t)(both && a > b) << (21 + face);
    }
    return key;
}

/* --- deriving ------------------------------------------------------------------------------------------------------
 */

/* A node is number 2 f + n. Sets of corners and nodes are bits. */
typedef struct derivation {
    hewn_label_cell *cell;
    uint8_t class[8];
    uint16_t arcs;     /* that are there */
    uint8_t region[8]; /* the lowest corner of those that a corner is joined with, over edges and across split faces */
    uint8_t ends[12][2]; /* the nodes at which an arc comes in and goes out */
    uint16_t piece;      /* arcs of the piece that is looked at: those that hang together over nodes */
    uint16_t nodes;      /* of the piece */
} derivation;

static void find_splits(derivation *of)
{
    for (unsigned face = 0; face < 6; face++) {
        uint8_t at[4];
        for (unsigned order = 0; order < 4; order++)
            at[order] = of->class[face_corner(face, order)];
        bool first = at[0] == at[2] && at[0] != at[1] && at[0] != at[3];
        bool second = at[1] == at[3] && at[1] != at[0] && at[1] != at[2];
        bool swapped = of->cell->key >> (21 + face) & 1;
        if (first && second)
            of->cell->split[face] = swapped ? 1 : 2;
        else
            of->cell->split[face] = first ? 2 : second ? 1 : 0;
        for (unsigned order = 0; order < 4; order++)
            of->cell->arcs[face] += at[order] != at[(order + 1) & 3];
    }
}

static void join_regions(derivation *of, unsigned a, unsigned b)
{
    uint8_t from = of->region[a], to = of->region[b], low = from < to ? from : to;
    for (int corner = 0; corner < 8; corner++)
        if (of->region[corner] == from || of->region[corner] == to)
            of->region[corner] = low;
}

static void find_regions(derivation *of)
{
    for (unsigned corner = 0; corner < 8; corner++)
        of->region[corner] = (uint8_t)corner;
    for (unsigned i = 0; i < 12; i++) {
        const hewn_cell_arc *arc = &hewn_cell_arcs[i];
        unsigned high = arc->low | 1u << arc->axis;
        if (of->class[arc->low] == of->class[high])
            join_regions(of, arc->low, high);
        else
            of->arcs |= (uint16_t)(1u << i);
    }
    for (unsigned face = 0; face < 6; face++) {
        unsigned joined = of->cell->split[face] == 1 ? 1 : 0;
        if (of->cell->split[face])
            join_regions(of, face_corner(face, joined), face_corner(face, joined + 2));
    }
}

static void find_ends(derivation *of)
{
    for (unsigned i = 0; i < 12; i++) {
        const hewn_cell_arc *arc = &hewn_cell_arcs[i];
        of->ends[i][0] = (uint8_t)(2 * arc->in + hewn_cell_node(of->cell, arc->in, arc->low, arc->axis));
        of->ends[i][1] = (uint8_t)(2 * arc->out + hewn_cell_node(of->cell, arc->out, arc->low, arc->axis));
    }
}

/* All arcs that hang together with the first of `left`, and their nodes. */
static void find_piece(derivation *of, uint16_t left)
{
    of->piece = (uint16_t)(left & -left);
    of->nodes = 0;
    for (uint16_t before = 0; before != of->piece;) {
        before = of->piece;
        for (unsigned i = 0; i < 12; i++)
            if (of->piece >> i & 1)
                of->nodes |= (uint16_t)(1u << of->ends[i][0] | 1u << of->ends[i][1]);
        for (unsigned i = 0; i < 12; i++)
            if (left >> i & 1 && (of->nodes >> of->ends[i][0] & 1 || of->nodes >> of->ends[i][1] & 1))
                of->piece |= (uint16_t)(1u << i);
    }
}

/* The mean of the middles of arcs. */
static void find_mean(uint16_t arcs, double out[3])
{
    double sum[3] = {0}, count = 0;
    for (unsigned i = 0; i < 12; i++) {
        const hewn_cell_arc *arc = &hewn_cell_arcs[i];
        if (!(arcs >> i & 1))
            continue;
        for (unsigned axis = 0; axis < 3; axis++)
            sum[axis] += axis == arc->axis ? 0.5 : (double)(arc->low >> axis & 1);
        count++;
    }
    for (unsigned axis = 0; axis < 3; axis++)
        out[axis] = sum[axis] / count;
}

/* Regions that the piece borders on, as bits of their lowest corners. */
static uint8_t find_bordering(const derivation *of)
{
    uint8_t regions = 0;
    for (unsigned i = 0; i < 12; i++)
        if (of->piece >> i & 1) {
            const hewn_cell_arc *arc = &hewn_cell_arcs[i];
            regions |= (uint8_t)(1u << of->region[arc->low] | 1u << of->region[arc->low | 1u << arc->axis]);
        }
    return regions;
}

/* Whether two of these regions have one label. */
static bool has_twins(const derivation *of, uint8_t regions)
{
    uint8_t seen = 0;
    for (unsigned corner = 0; corner < 8; corner++) {
        if (!(regions >> corner & 1))
            continue;
        if (seen >> of->class[corner] & 1)
            return true;
        seen |= (uint8_t)(1u << of->class[corner]);
    }
    return false;
}

/* One vertex, from which the faces of all arcs spread. */
static void place_vertex(derivation *of)
{
    hewn_label_cell *cell = of->cell;
    uint8_t vertex = cell->vertex_count++;
    find_mean(of->piece, cell->offset[vertex]);
    for (unsigned node = 0; node < 12; node++)
        if (of->nodes >> node & 1)
            cell->node[node / 2][node & 1] = vertex;
}

/* The class of most corners in these regions; the first of several. */
static unsigned find_filling(const derivation *of, uint8_t regions)
{
    unsigned count[8] = {0}, best = 0;
    for (unsigned corner = 0; corner < 8; corner++)
        count[of->class[corner]] += regions >> of->region[corner] & 1;
    for (unsigned class = 1; class < 8; class ++)
        best = count[class] > count[best] ? class : best;
    return best;
}

/* The cap of a region: along its border, against the faces of its arcs. */
static void add_cap(derivation *of, unsigned region, unsigned front)
{
    hewn_label_cell *cell = of->cell;
    hewn_cell_cap *cap = &cell->caps[cell->cap_count++];
    uint8_t next[12], start = HEWN_CELL_NONE;
    for (unsigned i = 0; i < 12; i++) {
        const hewn_cell_arc *arc = &hewn_cell_arcs[i];
        bool behind = of->region[arc->low] == region, before = of->region[arc->low | 1u << arc->axis] == region;
        if (!(of->piece >> i & 1) || behind == before)
            continue;
        uint8_t from = of->ends[i][behind ? 1 : 0], to = of->ends[i][behind ? 0 : 1];
        next[from] = to;
        start = from;
    }
    *cap = (hewn_cell_cap){.corner = (uint8_t)region, .front = (uint8_t)front};
    for (uint8_t at = start; cap->count == 0 || at != start; at = next[at])
        cap->vertices[cap->count++] = cell->node[at / 2][at & 1];
}

/* The middle is filled with the label of most corners, so that two regions of one label do not touch in a point: a
 * vertex for each node, between which the faces of arcs end, and a cap for each region of another label. */
static void fill_middle(derivation *of, uint8_t regions)
{
    hewn_label_cell *cell = of->cell;
    double middle[3], place[3];
    unsigned filling = find_filling(of, regions), front = 0;
    find_mean(of->piece, middle);
    for (unsigned node = 0; node < 12; node++) {
        if (!(of->nodes >> node & 1))
            continue;
        uint16_t arcs = 0;
        for (unsigned i = 0; i < 12; i++)
            if (of->piece >> i & 1 && (of->ends[i][0] == node || of->ends[i][1] == node))
                arcs |= (uint16_t)(1u << i);
        find_mean(arcs, place);
        for (int axis = 0; axis < 3; axis++)
            cell->offset[cell->vertex_count][axis] = (middle[axis] + place[axis]) / 2;
        cell->node[node / 2][node & 1] = cell->vertex_count++;
    }
    while (of->class[front] != filling)
        front++;
    for (unsigned corner = 0; corner < 8; corner++)
        if (regions >> corner & 1 && of->class[corner] != filling)
            add_cap(of, corner, front);
    for (unsigned i = 0; i < 12; i++) {
        const hewn_cell_arc *arc = &hewn_cell_arcs[i];
        if (!(of->piece >> i & 1))
            continue;
        const uint8_t *ends = of->ends[i];
        bool junction = of->class[arc->low] != filling && of->class[arc->low | 1u << arc->axis] != filling;
        cell->links[cell->link_count++] =
            (hewn_cell_link){cell->node[ends[0] / 2][ends[0] & 1], cell->node[ends[1] / 2][ends[1] & 1], junction};
    }
}

void hewn_cell_derive(uint32_t key, hewn_label_cell *out)
{
    derivation of = {.cell = out};
    *out = (hewn_label_cell){.key = key};
    memset(out->node, HEWN_CELL_NONE, sizeof out->node);
    for (unsigned corner = 0; corner < 8; corner++)
        of.class[corner] = (uint8_t)hewn_cell_class(key, corner);
    find_splits(&of);
    find_regions(&of);
    find_ends(&of);
    for (uint16_t left = of.arcs; left; left &= (uint16_t)~of.piece) {
        find_piece(&of, left);
        uint8_t regions = find_bordering(&of);
        if (has_twins(&of, regions))
            fill_middle(&of, regions);
        else
            place_vertex(&of);
    }
    out->owned_count = out->vertex_count;
    for (unsigned face = 0; face < 6; face += 2) {
        out->places[face] = out->owned_count;
        out->owned_count += out->split[face] ? 2 : 0;
    }
}

/* --- remembering ---------------------------------------------------------------------------------------------------
 */

static size_t find_slot(hewn_label_cell *const *slots, size_t count, uint32_t key)
{
    size_t at = key * (uint32_t)2654435761u >> 7 & (count - 1);
    while (slots[at] && slots[at]->key != key)
        at = (at + 1) & (count - 1);
    return at;
}

static bool grow(hewn_cell_memo *memo)
{
    size_t count = memo->slot_count ? 2 * memo->slot_count : 1024;
    hewn_label_cell **slots = hewn_alloc_zero(count, sizeof *slots);
    if (!slots)
        return false;
    for (size_t i = 0; i < memo->slot_count; i++)
        if (memo->slots[i])
            slots[find_slot(slots, count, memo->slots[i]->key)] = memo->slots[i];
    hewn_free(memo->slots);
    memo->slots = slots;
    memo->slot_count = count;
    return true;
}

const hewn_label_cell *hewn_cell_find(hewn_cell_memo *memo, uint32_t key)
{
    if (2 * memo->count >= memo->slot_count && !grow(memo))
        return NULL;
    size_t at = find_slot(memo->slots, memo->slot_count, key);
    if (!memo->slots[at]) {
        memo->slots[at] = hewn_alloc(1, sizeof(hewn_label_cell));
        if (!memo->slots[at])
            return NULL;
        hewn_cell_derive(key, memo->slots[at]);
        memo->count++;
    }
    return memo->slots[at];
}

void hewn_cell_memo_free(hewn_cell_memo *memo)
{
    for (size_t i = 0; i < memo->slot_count; i++)
        hewn_free(memo->slots[i]);
    hewn_free(memo->slots);
    *memo = (hewn_cell_memo){0};
}
