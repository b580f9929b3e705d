#include "iso/mc33.h"

#include <assert.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "iso/cube.h"

#define NO_EDGE 12u
#define MOST_LOOPS 4
#define MOST_WORDS 65536u

static bool is_in(uint32_t pattern, uint32_t corner)
{
    return pattern >> corner & 1;
}

static bool is_ambiguous(uint32_t pattern, const uint32_t corner[4])
{
    bool first = is_in(pattern, corner[0]), second = is_in(pattern, corner[1]);
    return first != second && first == is_in(pattern, corner[2]) && second == is_in(pattern, corner[3]);
}

uint32_t hewn_mc33_ambiguous(uint32_t pattern)
{
    uint32_t faces = 0, corner[4];
    for (uint32_t face = 0; face < 6; face++) {
        hewn_cube_face_corners(face, corner);
        faces |= is_ambiguous(pattern, corner) ? 1u << face : 0;
    }
    return faces;
}

/* --- loops and regions -------------------------------------------------------------------------------------------- */

/* A cell's surface: loops, and the region that each corner is in (the lowest corner of it). */
typedef struct outline {
    uint32_t region[8];
    uint32_t loop_count;
    hewn_loop loops[MOST_LOOPS];
    uint32_t sides[MOST_LOOPS][2]; /* the regions outside and inside of each loop */
} outline;

static void join_regions(outline *line, uint32_t a, uint32_t b)
{
    uint32_t from = line->region[a], to = line->region[b];
    uint32_t low = from < to ? from : to;
    for (uint32_t c = 0; c < 8; c++)
        if (line->region[c] == from || line->region[c] == to)
            line->region[c] = low;
}

/* On every face the cuts are directed so that the inside lies to their right seen from outside the cell: a cut arrives
 * where the way around the face enters the inside and leaves where it leaves it. Where the inside is joined, the two
 * cuts go around the outside corners instead. */
static void cut_face(uint32_t pattern, uint32_t face, bool joined, uint32_t next[12], outline *line)
{
    uint32_t corner[4];
    hewn_cube_face_corners(face, corner);
    bool ambiguous = is_ambiguous(pattern, corner);
    for (uint32_t i = 0; i < 4; i++) {
        uint32_t here = corner[i], after = corner[(i + 1) % 4], across = corner[(i + 2) % 4];
        bool in = is_in(pattern, here);
        if (in == is_in(pattern, after))
            join_regions(line, here, after);
        if (ambiguous && in == joined)
            join_regions(line, here, across);
        if (!in || is_in(pattern, after))
            continue;
        uint32_t leaving = hewn_cube_edge_between(here, after), begin = i;
        while (!ambiguous && is_in(pattern, corner[(begin + 3) % 4]))
            begin = (begin + 3) % 4;
        uint32_t arriving = hewn_cube_edge_between(corner[(begin + 3) % 4], corner[begin]);
        if (ambiguous && joined)
            arriving = hewn_cube_edge_between(after, across);
        next[arriving] = leaving;
    }
}

static void trace_loops(uint32_t pattern, uint32_t next[12], outline *line)
{
    for (uint32_t edge = 0; edge < 12; edge++) {
        hewn_loop loop = {0};
        for (uint32_t at = edge; next[at] != NO_EDGE;) {
            uint32_t after = next[at];
            next[at] = NO_EDGE;
            loop.edges[loop.length++] = at;
            at = after;
        }
        if (loop.length == 0)
            continue;
        assert(line->loop_count < MOST_LOOPS);
        uint32_t start = hewn_cube_edge_start(edge), end = start | 1u << edge / 4;
        line->sides[line->loop_count][is_in(pattern, start)] = line->region[start];
        line->sides[line->loop_count][is_in(pattern, end)] = line->region[end];
        line->loops[line->loop_count++] = loop;
    }
}

static void draw_outline(uint32_t pattern, uint32_t joined, outline *line)
{
    uint32_t next[12];
    *line = (outline){0};
    for (uint32_t corner = 0; corner < 8; corner++)
        line->region[corner] = corner;
    for (uint32_t edge = 0; edge < 12; edge++)
        next[edge] = NO_EDGE;
    for (uint32_t face = 0; face < 6; face++)
        cut_face(pattern, face, joined >> face & 1, next, line);
    trace_loops(pattern, next, line);
}

/* --- joins -------------------------------------------------------------------------------------------------------- */

/* The region of the upright edge over `corner` that has this sign; false where the edge has none. */
static bool edge_region(uint32_t pattern, const outline *line, uint32_t corner, bool in, uint32_t *region)
{
    if (is_in(pattern, corner) != in)
        corner += 4;
    *region = line->region[corner];
    return is_in(pattern, corner) == in;
}

/* The two loops that a join turns into one annulus: those between the joined regions. False where the two regions are
 * one already, or where this join cannot be. */
static bool find_annulus(uint32_t pattern, const outline *line, hewn_mc33_join join, uint32_t pair[2])
{
    if (join == HEWN_MC33_NO_JOIN)
        return false;
    bool in = join == HEWN_MC33_INSIDE_0 || join == HEWN_MC33_INSIDE_1;
    bool second = join == HEWN_MC33_OUTSIDE_1 || join == HEWN_MC33_INSIDE_1;
    uint32_t one, other;
    if (!edge_region(pattern, line, second ? 1 : 0, in, &one) ||
        !edge_region(pattern, line, second ? 2 : 3, in, &other) || one == other)
        return false;
    for (uint32_t i = 0; i < line->loop_count; i++)
        for (uint32_t j = 0; j < line->loop_count; j++)
            if (line->sides[i][in] == one && line->sides[j][in] == other &&
                line->sides[i][!in] == line->sides[j][!in]) {
                pair[0] = i;
                pair[1] = j;
                return true;
            }
    return false;
}

void hewn_mc33_patch(uint32_t pattern, uint32_t joined, hewn_mc33_join join, hewn_patch *out)
{
    outline line;
    uint32_t pair[2] = {MOST_LOOPS, MOST_LOOPS};
    *out = (hewn_patch){0};
    draw_outline(pattern, joined, &line);
    if (find_annulus(pattern, &line, join, pair)) {
        bool whole = hewn_patch_add_annulus(out, &line.loops[pair[0]], &line.loops[pair[1]]);
        assert(whole);
        (void)whole;
    }
    for (uint32_t i = 0; i < line.loop_count; i++)
        if (i != pair[0] && i != pair[1])
            hewn_patch_add_disc(out, &line.loops[i]);
}

/* --- the table ---------------------------------------------------------------------------------------------------- */

enum { RECORD_MOST = 1 + HEWN_PATCH_MOST_CENTRES / 2 + HEWN_PATCH_MOST_TRIANGLES / 2 };

static uint32_t write_record(const hewn_patch *patch, uint32_t words[RECORD_MOST])
{
    uint32_t first = 1 + (patch->centre_count + 1) / 2;
    memset(words, 0, RECORD_MOST * sizeof *words);
    words[0] = patch->triangle_count | patch->centre_count << 8;
    for (uint32_t i = 0; i < patch->centre_count; i++)
        words[1 + i / 2] |= patch->centres[i] << 16 * (i % 2);
    for (uint32_t i = 0; i < patch->triangle_count; i++)
        for (uint32_t corner = 0; corner < 3; corner++)
            words[first + i / 2] |= (uint32_t)patch->corners[i][corner] << (16 * (i % 2) + 4 * corner);
    return first + (patch->triangle_count + 1) / 2;
}

/* The place of the configuration's record, which is written if the pattern has none like it since `begin`. */
static uint32_t place_record(hewn_mc33_table *table, uint32_t begin, uint32_t pattern, uint32_t joined,
                             hewn_mc33_join join)
{
    hewn_patch patch;
    uint32_t words[RECORD_MOST];
    hewn_mc33_patch(pattern, joined, join, &patch);
    uint32_t length = write_record(&patch, words);
    for (uint32_t place = begin; place + length <= table->count; place++)
        if (memcmp(&table->words[place], words, length * sizeof *words) == 0)
            return place;
    uint32_t place = table->count;
    assert(place + length <= MOST_WORDS);
    memcpy(&table->words[place], words, length * sizeof *words);
    table->count += length;
    return place;
}

/* Bits of `value` go to the places of the bits of `mask`, lowest first. */
static uint32_t deposit(uint32_t value, uint32_t mask)
{
    uint32_t out = 0;
    for (uint32_t rest = mask; rest; rest &= rest - 1, value >>= 1)
        out |= value & 1 ? rest & ~(rest - 1) : 0;
    return out;
}

static void derive_pattern(hewn_mc33_table *table, uint32_t pattern)
{
    uint32_t ambiguous = hewn_mc33_ambiguous(pattern), combinations = 1;
    for (uint32_t rest = ambiguous; rest; rest &= rest - 1)
        combinations *= 2;
    uint32_t list = table->count, length = combinations * HEWN_MC33_JOINS;
    table->count += length;
    bool decides = false;
    for (uint32_t i = 0; i < length; i++) {
        uint32_t joined = deposit(i / HEWN_MC33_JOINS, ambiguous);
        uint32_t place = place_record(table, list + length, pattern, joined, (hewn_mc33_join)(i % HEWN_MC33_JOINS));
        table->words[list + i] = place;
        decides |= place != table->words[list];
    }
    table->words[pattern] = list | ambiguous << 16 | HEWN_MC33_DECIDES;
    if (!decides)
        table->words[pattern] = table->words[list];
}

hewn_result hewn_mc33_table_derive(hewn_mc33_table *out, hewn_error *error)
{
    *out = (hewn_mc33_table){.words = hewn_alloc_zero(MOST_WORDS, sizeof *out->words), .count = 256};
    if (!out->words)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for a table of configurations");
    for (uint32_t pattern = 0; pattern < 256; pattern++)
        derive_pattern(out, pattern);
    return HEWN_OK;
}

void hewn_mc33_table_destroy(hewn_mc33_table *table)
{
    hewn_free(table->words);
    *table = (hewn_mc33_table){0};
}
