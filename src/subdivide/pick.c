#include "subdivide/pick.h"

#include <math.h>

#include "base/alloc.h"

/* --- origins ------------------------------------------------------------------------------------------------------ */

static uint32_t parent_face(const hewn_subdivision *sub, uint32_t level, uint32_t face)
{
    return sub->masks.scheme == HEWN_SCHEME_LOOP ? face / 4 : sub_face_of(&sub->levels[level - 1], face);
}

uint32_t hewn_sub_face_origin(const hewn_subdivision *sub, uint32_t level, uint32_t face)
{
    for (; level > 0; level--)
        face = parent_face(sub, level, face);
    return face;
}

/* The triangle in the middle has a corner on each edge; it goes with the edge's first corner. */
uint32_t hewn_sub_corner_origin(const hewn_subdivision *sub, uint32_t level, uint32_t corner)
{
    for (; level > 0; level--) {
        uint32_t face = corner / 3;
        if (sub->masks.scheme != HEWN_SCHEME_LOOP)
            corner /= 4;
        else
            corner = face / 4 * 3 + (face % 4 < 3 ? face % 4 : corner % 3);
    }
    return corner;
}

/* --- picking ------------------------------------------------------------------------------------------------------ */

typedef struct picker {
    const hewn_subdivision *sub;
    const double *positions;
    double bound;
    sub_picks *picks;
} picker;

static double apart(const double *point, const double mean[3])
{
    double sum = 0;
    for (int i = 0; i < 3; i++)
        sum += (point[i] - mean[i]) * (point[i] - mean[i]);
    return sqrt(sum);
}

/* How far the vertices that the next level adds lie from where bilinear refinement would add them. */
static double miss(const picker *pick, const sub_level *level, uint32_t face)
{
    uint32_t begin = sub_face_begin(level, face), end = sub_face_begin(level, face + 1);
    double most = 0, mean[3] = {0, 0, 0}, middle[3];
    for (uint32_t c = begin; c < end; c++) {
        const double *a = pick->positions + 3 * (size_t)level->corner_verts[c];
        const double *b = pick->positions + 3 * (size_t)level->corner_verts[sub_next(level, c)];
        for (int i = 0; i < 3; i++) {
            middle[i] = (a[i] + b[i]) / 2;
            mean[i] += a[i] / (end - begin);
        }
        most = fmax(most, apart(pick->positions + 3 * ((size_t)level->verts + level->corner_edges[c]), middle));
    }
    if (pick->sub->masks.scheme != HEWN_SCHEME_LOOP)
        most = fmax(most, apart(pick->positions + 3 * ((size_t)level->verts + level->edges + face), mean));
    return most;
}

static hewn_result pick_face(picker *pick, uint32_t at, uint32_t face, hewn_error *error)
{
    const hewn_subdivision *sub = pick->sub;
    sub_picks *picks = pick->picks;
    const sub_level *level = &sub->levels[at];
    if (at == sub->count || (pick->bound > 0 && miss(pick, level, face) <= pick->bound)) {
        void *faces = picks->faces;
        HEWN_TRY(hewn_reserve(&faces, &picks->room, picks->count + 1, sizeof *picks->faces, error));
        picks->faces = faces;
        picks->faces[picks->count++] = (sub_picked){at, face};
        picks->coarse += at < sub->count;
        return HEWN_OK;
    }
    picks->refined[at][face] = 1;
    uint32_t begin = sub_face_begin(level, face), end = sub_face_begin(level, face + 1);
    bool loop = sub->masks.scheme == HEWN_SCHEME_LOOP;
    for (uint32_t child = loop ? 4 * face : begin; child < (loop ? 4 * face + 4 : end); child++)
        HEWN_TRY(pick_face(pick, at + 1, child, error));
    return HEWN_OK;
}

static bool touches_boundary(const sub_level *base, uint32_t face)
{
    for (uint32_t c = sub_face_begin(base, face); c < sub_face_begin(base, face + 1); c++)
        if (sub_is_boundary(base, base->vert_edges[base->vert_first[base->corner_verts[c]]]))
            return true;
    return false;
}

hewn_result hewn_sub_pick(const hewn_subdivision *sub, const double *positions, double error_bound, bool inner,
                          sub_picks *out, uint64_t *dropped, hewn_error *error)
{
    *out = (sub_picks){.levels = sub->count};
    picker pick = {sub, positions, error_bound, out};
    const sub_level *base = &sub->levels[0];
    out->refined = hewn_alloc_zero(sub->count, sizeof *out->refined);
    bool room = out->refined != NULL;
    for (uint32_t i = 0; room && i < sub->count; i++) {
        out->refined[i] = hewn_alloc_zero(sub->levels[i].faces, 1);
        room = out->refined[i] != NULL;
    }
    hewn_result result = room ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory picking faces");
    for (uint32_t f = 0; result == HEWN_OK && f < base->faces; f++) {
        if (inner && touches_boundary(base, f))
            (*dropped)++;
        else
            result = pick_face(&pick, 0, f, error);
    }
    if (result != HEWN_OK)
        hewn_sub_picks_free(out);
    return result;
}

void hewn_sub_picks_free(sub_picks *picks)
{
    for (uint32_t i = 0; picks->refined && i < picks->levels; i++)
        hewn_free(picks->refined[i]);
    hewn_free(picks->refined);
    hewn_free(picks->faces);
    *picks = (sub_picks){0};
}

/* --- walking ------------------------------------------------------------------------------------------------------ */

/* Edges in two numberings at once: those of `base` say whether an edge is split, those of `sub` name the vertices. */
typedef struct walker {
    const hewn_subdivision *base, *sub;
    const sub_picks *picks;
    sub_corner_visitor each;
    void *user;
    uint32_t corner;
} walker;

static bool is_split(const walker *walk, uint32_t at, uint32_t edge)
{
    const sub_level *level = &walk->base->levels[at];
    if (at == walk->base->count)
        return false;
    for (size_t k = 0; k < 2; k++) {
        uint32_t corner = level->edge_corners[2 * (size_t)edge + k];
        if (corner != HEWN_NONE && walk->picks->refined[at][sub_face_of(level, corner)])
            return true;
    }
    return false;
}

/* What lies between the ends of an edge, from the one that `forth` says on. */
static void walk_edge(const walker *walk, uint32_t at, uint32_t edge, bool forth, uint32_t other, bool other_forth)
{
    if (!is_split(walk, at, edge))
        return;
    uint32_t middle = walk->sub->levels[at].verts + other;
    walk_edge(walk, at + 1, 2 * edge + !forth, forth, 2 * other + !other_forth, other_forth);
    walk->each(walk->user, middle, walk->corner);
    walk_edge(walk, at + 1, 2 * edge + forth, forth, 2 * other + other_forth, other_forth);
}

void hewn_sub_walk(const hewn_subdivision *base, const hewn_subdivision *sub, const sub_picks *picks,
                   const sub_picked *face, sub_corner_visitor each, void *user)
{
    walker walk = {base, sub, picks, each, user, 0};
    const sub_level *level = &base->levels[face->level], *named = &sub->levels[face->level];
    for (uint32_t c = sub_face_begin(level, face->face); c < sub_face_begin(level, face->face + 1); c++) {
        walk.corner = c;
        each(user, named->corner_verts[c], c);
        if (face->level == base->count)
            continue;
        uint32_t edge = level->corner_edges[c], other = named->corner_edges[c];
        walk_edge(&walk, face->level, edge, level->edge_verts[2 * (size_t)edge] == level->corner_verts[c], other,
                  named->edge_verts[2 * (size_t)other] == named->corner_verts[c]);
    }
}
