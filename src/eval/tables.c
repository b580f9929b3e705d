/* Which outlines of a field go by tables: those of many sides, each for itself or several together. */
#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "eval/listing.h"
#include "field/outline.h"

enum {
    TABLE_FROM = 24,     /* sides: fewer cost less written out than a table that is read */
    TABLE_MOST = 250,    /* sides in one place: a loop over more is too long for drivers that bound those */
    TOGETHER_MOST = 1200 /* sides of several outlines in one table: far from a long row too many of them matter */
};

void hewn_listing_round_edge(const double edge[4], float out[HEWN_TABLE_SIDE])
{
    for (int i = 0; i < 4; i++)
        out[i] = hewn_listing_rounded(edge[i]);
    double x = (double)out[2] - (double)out[0], y = (double)out[3] - (double)out[1];
    double square = x * x + y * y;
    out[4] = hewn_listing_rounded(square > 0 ? fmin(1 / square, 1e29) : 0);
}

/* --- outlines that lie apart -------------------------------------------------------------------------------------- */

/* An outline of which the least with others is taken. */
typedef struct member {
    const hewn_node_data *node;
    double lo[2], hi[2];
    uint32_t sides;
} member;

/* What is known of nodes: outlines, and minima of outlines of the same coordinates that lie apart. */
typedef struct joining {
    const hewn_field *field;
    member *members; /* of all such nodes, one node's after another's */
    size_t count, capacity;
    struct {
        size_t first;
        uint32_t count; /* 0: no such node */
    } * of;             /* each node */
} joining;

static hewn_result measure(const hewn_field *field, member *out, hewn_error *error)
{
    double(*sides)[4] = hewn_alloc(out->sides, sizeof *sides);
    if (!sides)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for an outline");
    hewn_outline_sides(field, out->node, sides);
    for (int k = 0; k < 2; k++) {
        out->lo[k] = INFINITY;
        out->hi[k] = -INFINITY;
    }
    for (uint32_t i = 0; i < out->sides; i++)
        for (int k = 0; k < 4; k++) {
            out->lo[k & 1] = fmin(out->lo[k & 1], sides[i][k]);
            out->hi[k & 1] = fmax(out->hi[k & 1], sides[i][k]);
        }
    hewn_free(sides);
    return HEWN_OK;
}

/* So far apart that rounding does not make one's sides the nearest inside the other. */
static bool lie_apart(const member *a, const member *b)
{
    double gap = 0x1p-14 * (a->node->parameter[0] + b->node->parameter[0]);
    return a->lo[0] > b->hi[0] + gap || b->lo[0] > a->hi[0] + gap || a->lo[1] > b->hi[1] + gap ||
           b->lo[1] > a->hi[1] + gap;
}

/* Whether a chain goes back to where it starts, contour by contour: else a ray far from it may cross it. */
static bool is_closed(const hewn_field *field, const member *one)
{
    double(*sides)[4] = hewn_alloc(one->sides, sizeof *sides);
    if (!sides)
        return false;
    hewn_outline_sides(field, one->node, sides);
    bool closed = true;
    for (uint32_t first = 0, i = 0; i < one->sides && closed; i++) {
        bool last = i + 1 == one->sides || sides[i + 1][0] != sides[i][2] || sides[i + 1][1] != sides[i][3];
        if (!last)
            continue;
        closed = sides[i][2] == sides[first][0] && sides[i][3] == sides[first][1];
        first = i + 1;
    }
    hewn_free(sides);
    return closed;
}

static hewn_result add_outline(joining *own, uint32_t id, hewn_error *error)
{
    member one = {.node = hewn_field_node(own->field, id)};
    one.sides = hewn_outline_count(own->field, one.node);
    if (one.sides == 0)
        return HEWN_OK;
    HEWN_TRY(measure(own->field, &one, error));
    void *members = own->members;
    HEWN_TRY(hewn_reserve(&members, &own->capacity, own->count + 1, sizeof one, error));
    own->members = members;
    own->of[id].first = own->count;
    own->of[id].count = 1;
    own->members[own->count++] = one;
    return HEWN_OK;
}

static bool fit_together(const joining *own, const hewn_node_data *minimum)
{
    const member *lists[2];
    uint32_t counts[2], sides = 0;
    for (int k = 0; k < 2; k++) {
        counts[k] = own->of[minimum->operand[k]].count;
        if (counts[k] == 0 || !own->members)
            return false;
        lists[k] = own->members + own->of[minimum->operand[k]].first;
    }
    for (int k = 0; k < 2; k++)
        for (uint32_t i = 0; i < counts[k]; i++)
            sides += lists[k][i].sides;
    if (sides > TOGETHER_MOST || lists[0]->node->operand[1] != lists[1]->node->operand[1] ||
        lists[0]->node->operand[2] != lists[1]->node->operand[2])
        return false;
    for (uint32_t i = 0; i < counts[0]; i++)
        for (uint32_t k = 0; k < counts[1]; k++)
            if (!lie_apart(&lists[0][i], &lists[1][k]))
                return false;
    for (int k = 0; k < 2; k++)
        if (counts[k] == 1 && !is_closed(own->field, lists[k]))
            return false;
    return true;
}

static hewn_result join(joining *own, uint32_t id, hewn_error *error)
{
    const hewn_node_data *node = hewn_field_node(own->field, id);
    if (!fit_together(own, node))
        return HEWN_OK;
    size_t first = own->count;
    void *members = own->members;
    uint32_t counts[2] = {own->of[node->operand[0]].count, own->of[node->operand[1]].count};
    HEWN_TRY(hewn_reserve(&members, &own->capacity, first + counts[0] + counts[1], sizeof *own->members, error));
    own->members = members;
    for (int k = 0; k < 2; k++) {
        memcpy(own->members + own->count, own->members + own->of[node->operand[k]].first,
               counts[k] * sizeof *own->members);
        own->count += counts[k];
    }
    own->of[id].first = first;
    own->of[id].count = counts[0] + counts[1];
    return HEWN_OK;
}

static hewn_result find_outlines(joining *own, const uint32_t *ids, size_t count, hewn_error *error)
{
    for (size_t i = 0; i < count; i++) {
        hewn_op op = hewn_field_node(own->field, ids[i])->op;
        if (op == HEWN_OP_OUTLINE)
            HEWN_TRY(add_outline(own, ids[i], error));
        else if (op == HEWN_OP_MIN)
            HEWN_TRY(join(own, ids[i], error));
    }
    return HEWN_OK;
}

/* --- tables ------------------------------------------------------------------------------------------------------- */

static hewn_result round_sides(const joining *own, const member *members, uint32_t count,
                               float (*edges)[HEWN_TABLE_SIDE], uint32_t all, hewn_error *error)
{
    double(*sides)[4] = hewn_alloc(all, sizeof *sides);
    if (!sides)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for an outline");
    for (uint32_t i = 0, at = 0; i < count; at += members[i++].sides)
        hewn_outline_sides(own->field, members[i].node, sides + at);
    for (uint32_t i = 0; i < all; i++)
        hewn_listing_round_edge(sides[i], edges[i]);
    hewn_free(sides);
    return HEWN_OK;
}

/* The table of what a node is, if it is worth one. Where several together have none, the next that is tried has at most
 * half of their sides. */
static hewn_result make_table(hewn_listing *listing, const joining *own, uint32_t id, hewn_table_use *use,
                              hewn_error *error)
{
    const member *members = own->members + own->of[id].first;
    uint32_t count = own->of[id].count, all = 0;
    double size = 0;
    for (uint32_t i = 0; i < count; i++) {
        all += members[i].sides;
        size = fmax(size, members[i].node->parameter[0]);
    }
    if (all < TABLE_FROM || (use->most > 0 && all > use->most))
        return HEWN_OK;
    void *tables = listing->tables;
    size_t capacity = listing->table_count;
    HEWN_TRY(hewn_reserve(&tables, &capacity, listing->table_count + 1, sizeof *listing->tables, error));
    listing->tables = tables;
    float(*edges)[HEWN_TABLE_SIDE] = hewn_alloc(all, sizeof *edges);
    hewn_outline_table *made = &listing->tables[listing->table_count];
    hewn_result result = edges ? round_sides(own, members, count, edges, all, error)
                               : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for an outline");
    if (result == HEWN_OK)
        result = hewn_outline_table_create((const float(*)[HEWN_TABLE_SIDE])edges, all, hewn_listing_rounded(size),
                                           TABLE_MOST, made, error);
    if (result == HEWN_OK && made->words) {
        use->table = (uint32_t)++listing->table_count;
        use->at[0] = members[0].node->operand[1];
        use->at[1] = members[0].node->operand[2];
    } else {
        use->most = count > 1 ? all / 2 : 0;
    }
    hewn_free(edges);
    return result;
}

/* From the root down, so that what is joined has one table and its parts have none. */
static hewn_result use_tables(hewn_listing *listing, const joining *own, const uint32_t *ids, size_t count,
                              hewn_table_use *uses, hewn_error *error)
{
    uses[ids[count - 1]].needed = true;
    for (size_t i = count; i-- > 0;) {
        const hewn_node_data *node = hewn_field_node(own->field, ids[i]);
        hewn_table_use *use = &uses[ids[i]];
        if (!use->needed)
            continue;
        if (own->members && own->of[ids[i]].count > 0)
            HEWN_TRY(make_table(listing, own, ids[i], use, error));
        for (uint32_t k = 0; k < 2 && use->table; k++)
            uses[use->at[k]].needed = true;
        for (uint32_t k = 0; k < hewn_op_infos[node->op].operands && !use->table; k++) {
            uses[node->operand[k]].needed = true;
            uses[node->operand[k]].most = own->of[node->operand[k]].count > 1 ? use->most : 0;
        }
    }
    return HEWN_OK;
}

hewn_result hewn_listing_make_tables(hewn_listing *listing, const hewn_field *field, const uint32_t *ids, size_t count,
                                     bool chained, hewn_table_use *uses, hewn_error *error)
{
    joining own = {.field = field};
    own.of = hewn_alloc_zero(hewn_field_node_count(field), sizeof *own.of);
    hewn_result result =
        own.of ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory listing %zu operations", count);
    if (result == HEWN_OK && !chained)
        result = find_outlines(&own, ids, count, error);
    if (result == HEWN_OK)
        result = use_tables(listing, &own, ids, count, uses, error);
    hewn_free(own.members);
    hewn_free(own.of);
    return result;
}
