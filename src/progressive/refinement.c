#include "hewn/refinement.h"

#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "progressive/hierarchy.h"

/* Splits that are looked at for what comes next: a list, and where each stands in it. */
typedef struct frontier {
    uint32_t *items, *places;
    size_t count;
} frontier;

struct hewn_refinement {
    const hewn_progressive *from;
    progressive_hierarchy links;
    uint8_t *done;       /* of splits */
    uint32_t *carried;   /* how many above each are done */
    frontier next, open; /* not done, but their parents are; done, but none above is */
    uint32_t *stack;
    size_t stack_room;
    uint32_t *wedges;         /* of triangles' corners */
    uint32_t *drawn, *places; /* the triangles that there are, and where each stands */
    uint32_t *indices;        /* their vertices */
    size_t drawn_count;
};

/* --- frontiers ---------------------------------------------------------------------------------------------------- */

static void enter(frontier *in, uint32_t split)
{
    in->places[split] = (uint32_t)in->count;
    in->items[in->count++] = split;
}

static void leave(frontier *in, uint32_t split)
{
    const uint32_t place = in->places[split], last = in->items[--in->count];
    in->items[place] = last;
    in->places[last] = place;
}

static bool begin_frontier(frontier *in, size_t count)
{
    in->items = hewn_alloc(count, sizeof *in->items);
    in->places = hewn_alloc(count, sizeof *in->places);
    return in->items && in->places;
}

/* --- life --------------------------------------------------------------------------------------------------------- */

static void draw(hewn_refinement *of, uint32_t triangle)
{
    const size_t place = of->drawn_count++;
    of->drawn[place] = triangle;
    of->places[triangle] = (uint32_t)place;
    for (size_t k = 0; k < 3; k++)
        of->indices[3 * place + k] = of->from->wedge_vertices[of->wedges[3 * (size_t)triangle + k]];
}

static void erase(hewn_refinement *of, uint32_t triangle)
{
    const size_t place = of->places[triangle], last = --of->drawn_count;
    of->drawn[place] = of->drawn[last];
    of->places[of->drawn[place]] = (uint32_t)place;
    memmove(of->indices + 3 * place, of->indices + 3 * last, 3 * sizeof *of->indices);
}

static hewn_result begin(hewn_refinement *of, hewn_error *error)
{
    const hewn_progressive *from = of->from;
    const size_t splits = from->split_count, triangles = from->triangle_count;
    of->done = hewn_alloc_zero(splits, sizeof *of->done);
    of->carried = hewn_alloc_zero(splits, sizeof *of->carried);
    of->wedges = hewn_alloc(triangles, 3 * sizeof *of->wedges);
    of->drawn = hewn_alloc(triangles, sizeof *of->drawn);
    of->places = hewn_alloc(triangles, sizeof *of->places);
    of->indices = hewn_alloc(triangles, 3 * sizeof *of->indices);
    if (!of->done || !of->carried || !of->wedges || !of->drawn || !of->places || !of->indices ||
        !begin_frontier(&of->next, splits) || !begin_frontier(&of->open, splits))
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for refinement");
    HEWN_TRY(hewn_hierarchy_make(from, &of->links, error));
    if (triangles > 0)
        memcpy(of->wedges, from->triangles, 3 * triangles * sizeof *of->wedges);
    for (uint32_t t = 0; t < from->base_triangles; t++)
        draw(of, t);
    for (uint32_t i = 0; i < splits; i++)
        if (of->links.parents[i] == HEWN_NONE)
            enter(&of->next, i);
    return HEWN_OK;
}

hewn_result hewn_refinement_create(const hewn_progressive *progressive, hewn_refinement **out, hewn_error *error)
{
    *out = NULL;
    hewn_refinement *made = hewn_alloc_zero(1, sizeof *made);
    if (!made)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for refinement");
    made->from = progressive;
    hewn_result result = begin(made, error);
    if (result == HEWN_OK)
        *out = made;
    else
        hewn_refinement_destroy(&made);
    return result;
}

void hewn_refinement_destroy(hewn_refinement **refinement)
{
    hewn_refinement *of = *refinement;
    if (!of)
        return;
    hewn_hierarchy_release(&of->links);
    hewn_free(of->done);
    hewn_free(of->carried);
    hewn_free(of->next.items);
    hewn_free(of->next.places);
    hewn_free(of->stack);
    hewn_free(of->open.items);
    hewn_free(of->open.places);
    hewn_free(of->wedges);
    hewn_free(of->drawn);
    hewn_free(of->places);
    hewn_free(of->indices);
    hewn_free(of);
    *refinement = NULL;
}

/* --- steps -------------------------------------------------------------------------------------------------------- */

static void set_corner(hewn_refinement *of, uint32_t corner, uint32_t wedge)
{
    of->wedges[corner] = wedge;
    of->indices[3 * (size_t)of->places[corner / 3] + corner % 3] = of->from->wedge_vertices[wedge];
}

static void do_split(hewn_refinement *of, uint32_t i)
{
    const hewn_progressive *from = of->from;
    const progressive_links *below = &of->links.below;
    for (uint32_t c = from->splits[i].first_change; c < progressive_changes_at(from, i + 1ull); c++)
        set_corner(of, from->changes[c].corner, from->changes[c].after);
    for (uint32_t t = from->splits[i].first_triangle; t < progressive_triangles_at(from, i + 1ull); t++)
        draw(of, t);
    of->done[i] = 1;
    leave(&of->next, i);
    enter(&of->open, i);
    for (uint32_t k = below->first[i]; k < below->first[i + 1]; k++)
        if (of->carried[below->to[k]]++ == 0)
            leave(&of->open, below->to[k]);
    for (size_t k = 0; k < 2; k++)
        if (of->links.children[2 * (size_t)i + k] != HEWN_NONE)
            enter(&of->next, of->links.children[2 * (size_t)i + k]);
}

static void fold_split(hewn_refinement *of, uint32_t i)
{
    const hewn_progressive *from = of->from;
    const progressive_links *below = &of->links.below;
    for (uint32_t c = from->splits[i].first_change; c < progressive_changes_at(from, i + 1ull); c++)
        set_corner(of, from->changes[c].corner, from->changes[c].before);
    for (uint32_t t = from->splits[i].first_triangle; t < progressive_triangles_at(from, i + 1ull); t++)
        erase(of, t);
    of->done[i] = 0;
    leave(&of->open, i);
    enter(&of->next, i);
    for (uint32_t k = below->first[i]; k < below->first[i + 1]; k++)
        if (--of->carried[below->to[k]] == 0)
            enter(&of->open, below->to[k]);
    for (size_t k = 0; k < 2; k++)
        if (of->links.children[2 * (size_t)i + k] != HEWN_NONE)
            leave(&of->next, of->links.children[2 * (size_t)i + k]);
}

/* Does a split, and first what it stands on. */
static hewn_result force(hewn_refinement *of, uint32_t split, uint64_t *count, hewn_error *error)
{
    const progressive_links *below = &of->links.below;
    size_t depth = 0;
    HEWN_TRY(hewn_reserve((void **)&of->stack, &of->stack_room, 1, sizeof *of->stack, error));
    of->stack[depth++] = split;
    while (depth > 0) {
        const uint32_t i = of->stack[depth - 1];
        uint32_t k = below->first[i];
        while (k < below->first[i + 1] && of->done[below->to[k]])
            k++;
        if (k < below->first[i + 1]) {
            HEWN_TRY(hewn_reserve((void **)&of->stack, &of->stack_room, depth + 1, sizeof *of->stack, error));
            of->stack[depth++] = below->to[k];
            continue;
        }
        do_split(of, i);
        ++*count;
        depth--;
    }
    return HEWN_OK;
}

/* --- views -------------------------------------------------------------------------------------------------------- */

static double or_one(double factor)
{
    return factor == 0 ? 1 : factor;
}

static double outside_of(const hewn_refinement_view *view)
{
    return view->outside == 0 ? or_one(view->back) : view->outside;
}

static hewn_result check_view(const hewn_refinement_view *view, hewn_error *error)
{
    const double outside = outside_of(view), back = or_one(view->back), silhouette = or_one(view->silhouette);
    bool right = isfinite(view->eye[0]) && isfinite(view->eye[1]) && isfinite(view->eye[2]) && view->plane_count <= 6;
    right &= view->pixels > 0 && isfinite(view->pixels) && view->tolerance >= 0;
    for (uint32_t p = 0; right && p < view->plane_count; p++)
        for (int k = 0; k < 4; k++)
            right &= isfinite(view->planes[p][k]);
    if (!right)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a view has a finite eye and planes, pixels and a tolerance");
    if (!(silhouette > 0 && silhouette <= 1 && back >= 1 && outside >= back))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "factors of tolerances: above 0 to 1 for silhouettes, 1 and more for what is turned away, "
                         "and no less for what is outside");
    return HEWN_OK;
}

/* What the tolerance is multiplied by. Where a region lies in another, it gets no less than that: so no split shows
 * whose parent does not, and it is enough to look at those whose parents are done. */
static double factor_of(const progressive_region *of, const double to[3], double distance,
                        const hewn_refinement_view *view)
{
    for (uint32_t p = 0; p < view->plane_count; p++) {
        const double *plane = view->planes[p];
        const double above = plane[0] * of->center[0] + plane[1] * of->center[1] + plane[2] * of->center[2] + plane[3];
        if (above < -of->radius)
            return outside_of(view);
    }
    if (distance <= of->radius || of->angle < 0)
        return or_one(view->silhouette);
    const double cosine = (of->axis[0] * to[0] + of->axis[1] * to[1] + of->axis[2] * to[2]) / distance;
    const double off = acos(fmax(-1, fmin(1, cosine))) - M_PI / 2, spread = of->angle + asin(of->radius / distance);
    if (off < -spread)
        return or_one(view->back);
    return off > spread ? 1 : or_one(view->silhouette);
}

/* Whether a split is needed: its error would show. */
static bool shows(const hewn_refinement *in, uint32_t i, const hewn_refinement_view *view)
{
    const progressive_region *of = &in->links.regions[i];
    const double to[3] = {of->center[0] - view->eye[0], of->center[1] - view->eye[1], of->center[2] - view->eye[2]};
    const double distance = sqrt(to[0] * to[0] + to[1] * to[1] + to[2] * to[2]);
    if (view->tolerance == 0)
        return true;
    const double allowed = view->tolerance * factor_of(of, to, distance, view);
    return of->error * view->pixels > allowed * fmax(distance - of->radius, 0);
}

/* --- updates ------------------------------------------------------------------------------------------------------ */

/* What was folded lets coarser splits be folded, which then come later in the same list. */
static bool fold_all(hewn_refinement *of, const hewn_refinement_view *view, uint64_t most, hewn_refinement_stats *stats)
{
    for (size_t at = 0; at < of->open.count;) {
        const uint32_t i = of->open.items[at];
        stats->tested++;
        if (shows(of, i, view)) {
            at++;
            continue;
        }
        if (stats->splits + stats->folds >= most)
            return false;
        fold_split(of, i); /* another takes its place */
        stats->folds++;
    }
    return true;
}

/* What comes forward in the list was not looked at yet, so it is gone through until nothing is left to do. */
static hewn_result split_all(hewn_refinement *of, const hewn_refinement_view *view, uint64_t most,
                             hewn_refinement_stats *stats, hewn_error *error)
{
    for (bool again = true; again;) {
        again = false;
        for (size_t at = 0; at < of->next.count;) {
            const uint32_t i = of->next.items[at];
            stats->tested++;
            if (!shows(of, i, view)) {
                at++;
                continue;
            }
            if (stats->splits + stats->folds >= most)
                return HEWN_OK;
            HEWN_TRY(force(of, i, &stats->splits, error));
            again = true;
        }
    }
    stats->settled = true;
    return HEWN_OK;
}

hewn_result hewn_refinement_update(hewn_refinement *refinement, const hewn_refinement_view *view, uint64_t most,
                                   hewn_refinement_stats *stats, hewn_error *error)
{
    hewn_refinement_stats own = {0};
    HEWN_TRY(check_view(view, error));
    const uint64_t limit = most > 0 ? most : UINT64_MAX;
    if (fold_all(refinement, view, limit, &own))
        HEWN_TRY(split_all(refinement, view, limit, &own, error));
    if (stats)
        *stats = own;
    return HEWN_OK;
}

/* --- the mesh ----------------------------------------------------------------------------------------------------- */

const uint32_t *hewn_refinement_triangles(const hewn_refinement *refinement, uint64_t *count)
{
    *count = refinement->drawn_count;
    return refinement->indices;
}

hewn_result hewn_refinement_model(const hewn_refinement *refinement, hewn_model *out, hewn_error *error)
{
    const hewn_progressive *from = refinement->from;
    uint8_t *drawn = hewn_alloc_zero(from->triangle_count, 1);
    *out = (hewn_model){0};
    if (!drawn)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a refined mesh");
    for (size_t i = 0; i < refinement->drawn_count; i++)
        drawn[refinement->drawn[i]] = 1;
    hewn_result result = hewn_progressive_gather(from, refinement->wedges, drawn, out, error);
    hewn_free(drawn);
    if (result != HEWN_OK)
        hewn_model_destroy(out);
    return result;
}
