#include "subdivide/seams.h"

#include <string.h>

#include "base/alloc.h"

typedef struct seams {
    const sub_level *base;
    const unsigned char *values;
    size_t stride;
    uint32_t *root;      /* of each corner in a union-find */
    uint32_t *number;    /* of its value */
    uint32_t *sources;   /* of each value */
    uint32_t count;      /* of values */
    uint32_t *at_vert;   /* how many values a vertex has */
    uint32_t *faces;     /* of each value */
    uint8_t *has_corner; /* of each vertex: a value of one face only */
} seams;

static uint32_t find_root(uint32_t *root, uint32_t c)
{
    while (root[c] != c)
        c = root[c] = root[root[c]];
    return c;
}

static void join(uint32_t *root, uint32_t a, uint32_t b)
{
    a = find_root(root, a);
    b = find_root(root, b);
    root[a > b ? a : b] = a < b ? a : b;
}

static bool same(const seams *cut, uint32_t a, uint32_t b)
{
    return memcmp(cut->values + a * cut->stride, cut->values + b * cut->stride, cut->stride) == 0;
}

static void join_corners(seams *cut)
{
    const sub_level *base = cut->base;
    for (uint32_t c = 0; c < base->corners; c++)
        cut->root[c] = c;
    for (uint32_t e = 0; e < base->edges; e++) {
        uint32_t a = base->edge_corners[2 * (size_t)e], b = base->edge_corners[2 * (size_t)e + 1];
        if (b == HEWN_NONE)
            continue;
        uint32_t after_a = sub_next(base, a), after_b = sub_next(base, b);
        if (!same(cut, a, after_b) || !same(cut, after_a, b))
            continue;
        join(cut->root, a, after_b);
        join(cut->root, after_a, b);
    }
    for (uint32_t c = 0; c < base->corners; c++) /* a root is the least of its corners, so it is numbered first */
        if (find_root(cut->root, c) == c) {
            cut->number[c] = cut->count;
            cut->sources[cut->count++] = c;
            cut->at_vert[base->corner_verts[c]]++;
        }
    for (uint32_t c = 0; c < base->corners; c++) {
        cut->number[c] = cut->number[find_root(cut->root, c)];
        cut->faces[cut->number[c]]++;
    }
}

/* Where linear interpolation is asked for. */
static bool is_linear(const seams *cut, const sub_level *level, uint32_t value, hewn_uv_rule rule)
{
    uint32_t vert = cut->base->corner_verts[cut->sources[value]], edge = level->vert_edges[level->vert_first[value]];
    bool open = sub_is_boundary(level, edge), plus2 = rule == HEWN_UV_CORNERS_PLUS2;
    bool closed = !sub_is_boundary(cut->base, cut->base->vert_edges[cut->base->vert_first[vert]]);
    if (!open || rule == HEWN_UV_NONE)
        return false;
    if (rule == HEWN_UV_BOUNDARIES || cut->faces[value] == 1)
        return true;
    if (cut->at_vert[vert] > 2 && (plus2 || rule == HEWN_UV_CORNERS_PLUS1))
        return true;
    if (plus2 && cut->at_vert[vert] == 1 && closed)
        return true;
    return plus2 && cut->at_vert[vert] == 2 && cut->has_corner[vert];
}

static hewn_result tag(seams *cut, sub_level *level, hewn_uv_rule rule, hewn_error *error)
{
    const sub_level *base = cut->base;
    if (base->edge_sharp)
        HEWN_TRY(hewn_sub_level_sharpen(level, error));
    if (!level->edge_sharp)
        return HEWN_OK;
    for (uint32_t value = 0; value < cut->count; value++)
        if (cut->faces[value] == 1)
            cut->has_corner[base->corner_verts[cut->sources[value]]] = 1;
    for (uint32_t c = 0; c < base->corners && base->edge_sharp; c++)
        if (!sub_is_boundary(level, level->corner_edges[c]))
            level->edge_sharp[level->corner_edges[c]] = base->edge_sharp[base->corner_edges[c]];
    for (uint32_t value = 0; value < cut->count; value++) {
        float own = base->vert_sharp ? base->vert_sharp[base->corner_verts[cut->sources[value]]] : 0;
        level->vert_sharp[value] = is_linear(cut, level, value, rule) ? SHARP_FOREVER : own;
    }
    return HEWN_OK;
}

static hewn_result create_level(seams *cut, hewn_uv_rule rule, sub_level *out, hewn_error *error)
{
    const sub_level *base = cut->base;
    double *zero = hewn_alloc_zero(cut->count, 3 * sizeof *zero);
    uint64_t *first = base->sides == 3 ? NULL : hewn_alloc((size_t)base->faces + 1, sizeof *first);
    if (!zero || (base->sides != 3 && !first)) {
        hewn_free(zero);
        hewn_free(first);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for values of corners");
    }
    for (uint32_t f = 0; first && f <= base->faces; f++)
        first[f] = f < base->faces ? sub_face_begin(base, f) : base->corners;
    hewn_polygons polygons = {cut->count, zero, base->faces, first, cut->number};
    hewn_result result = hewn_sub_level_create(&polygons, out, error);
    hewn_free(zero);
    hewn_free(first);
    return result == HEWN_OK ? tag(cut, out, rule, error) : result;
}

static hewn_result build(seams *cut, const hewn_subdivision *base, hewn_uv_rule rule, hewn_subdivision *out,
                         hewn_error *error)
{
    join_corners(cut);
    HEWN_TRY(create_level(cut, rule, &out->levels[0], error));
    out->count = base->count;
    out->masks = base->masks;
    out->limit = base->limit;
    out->masks.linear = rule == HEWN_UV_ALL || base->masks.scheme == HEWN_SCHEME_BILINEAR;
    return hewn_subdivision_grow(out, &(hewn_subdivide_desc){0}, error);
}

hewn_result hewn_sub_seams(const hewn_subdivision *base, const void *values, size_t stride, hewn_uv_rule rule,
                           hewn_subdivision **out, uint32_t **sources, hewn_error *error)
{
    const sub_level *level = &base->levels[0];
    seams cut = {.base = level, .values = values, .stride = stride};
    *sources = NULL;
    *out = hewn_alloc_zero(1, sizeof **out);
    cut.root = hewn_alloc(level->corners, sizeof *cut.root);
    cut.number = hewn_alloc(level->corners, sizeof *cut.number);
    cut.sources = hewn_alloc(level->corners, sizeof *cut.sources);
    cut.at_vert = hewn_alloc_zero(level->verts, sizeof *cut.at_vert);
    cut.faces = hewn_alloc_zero(level->corners, sizeof *cut.faces);
    cut.has_corner = hewn_alloc_zero(level->verts, 1);
    hewn_result result = HEWN_OK;
    if (!*out || !cut.root || !cut.number || !cut.sources || !cut.at_vert || !cut.faces || !cut.has_corner)
        result = hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for values of corners");
    if (result == HEWN_OK)
        result = build(&cut, base, rule, *out, error);
    hewn_free(cut.root);
    hewn_free(cut.number);
    hewn_free(cut.at_vert);
    hewn_free(cut.faces);
    hewn_free(cut.has_corner);
    if (result == HEWN_OK) {
        *sources = cut.sources;
        return HEWN_OK;
    }
    hewn_free(cut.sources);
    hewn_subdivision_destroy(out);
    return result;
}
