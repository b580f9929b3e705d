#include "io/glb_topology.h"

#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/progress.h"

static hewn_result look_up(const hewn_writing *job, uint64_t done, hewn_error *error)
{
    return done % (16 * HEWN_WRITE_BLOCK) == 0 ? hewn_progress_report(job->progress, "write", 0, error) : HEWN_OK;
}

/* --- equal positions ---------------------------------------------------------------------------------------------- */

/* The bits of a position, -0 made 0. */
static void get_key(const hewn_writing *job, const hewn_glb_plan *plan, uint64_t vertex, uint32_t key[3])
{
    float p[3];
    hewn_glb_position(job, plan, vertex, p);
    for (int axis = 0; axis < 3; axis++)
        p[axis] += 0.0f;
    memcpy(key, p, sizeof p);
}

/* As the finaliser of Steele, Lea and Flood 2014 ('Fast splittable pseudorandom number generators'). */
static uint64_t hash_key(const uint32_t key[3])
{
    uint64_t hash = ((uint64_t)key[1] << 32 | key[0]) * 0x9e3779b97f4a7c15u;
    hash = (hash ^ hash >> 30 ^ key[2]) * 0xbf58476d1ce4e5b9u;
    hash = (hash ^ hash >> 27) * 0x94d049bb133111ebu;
    return hash ^ hash >> 31;
}

/* A bit for each of some hashes: whether any vertex has it, and whether several do. Few do by chance, so that few are
 * to be compared; and bits are so few bytes that they stay near the processor. */
typedef struct hash_bits {
    uint64_t *any, *several;
    uint64_t mask;
    uint64_t again; /* vertices whose bit was set before */
} hash_bits;

enum { LEAST_BITS = 1 << 10, MOST_BITS = 1 << 28, RUN = 64 };

static bool has_bit(const uint64_t *bits, uint64_t at)
{
    return bits[at / 64] >> at % 64 & 1;
}

/* The hashes of a run of vertices, whose bits, which lie anywhere, are all asked for at once. */
static uint64_t hash_run(const hewn_writing *job, const hewn_glb_plan *plan, uint64_t begin, const uint64_t *bits,
                         uint64_t mask, uint64_t hashes[RUN])
{
    const uint64_t end = job->vertex_count - begin < RUN ? job->vertex_count : begin + RUN;
    for (uint64_t v = begin; v < end; v++) {
        uint32_t key[3];
        get_key(job, plan, v, key);
        hashes[v - begin] = hash_key(key);
        __builtin_prefetch(&bits[(hashes[v - begin] & mask) / 64]);
    }
    return end;
}

static void free_bits(hash_bits *bits)
{
    hewn_free(bits->any);
    hewn_free(bits->several);
}

static hewn_result set_bits(const hewn_writing *job, const hewn_glb_plan *plan, hash_bits *out, hewn_error *error)
{
    uint64_t count = LEAST_BITS;
    while (count < 8 * job->vertex_count && count < MOST_BITS)
        count *= 2;
    *out = (hash_bits){hewn_alloc_zero(count / 64, sizeof(uint64_t)), hewn_alloc_zero(count / 64, sizeof(uint64_t)),
                       count - 1, 0};
    if (!out->any || !out->several)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for writing");
    for (uint64_t begin = 0, end; begin < job->vertex_count; begin = end) {
        uint64_t hashes[RUN];
        end = hash_run(job, plan, begin, out->any, out->mask, hashes);
        for (uint64_t v = begin; v < end; v++) {
            const uint64_t at = hashes[v - begin] & out->mask;
            if (has_bit(out->any, at)) {
                out->several[at / 64] |= (uint64_t)1 << at % 64;
                out->again++;
            }
            out->any[at / 64] |= (uint64_t)1 << at % 64;
            HEWN_TRY(look_up(job, v, error));
        }
    }
    return HEWN_OK;
}

/* A vertex and the high bits of its hash, so that only those that are likely to be equal are read again. */
typedef struct slot {
    uint32_t vertex, hash;
} slot;

/* What memory may be spent on slots: where more vertices are to be compared, those of some hashes are at a time. */
enum { MOST_SLOTS = 1 << 22 };

typedef struct slot_table {
    slot *slots;
    size_t count, used; /* of which at least one stays free */
} slot_table;

/* Looks for a vertex at the same place as `v`, and puts it into the table. */
static bool meets_equal(const hewn_writing *job, const hewn_glb_plan *plan, slot_table *table, uint64_t v,
                        uint64_t hash, uint64_t rounds)
{
    uint32_t key[3], other[3];
    slot *slots = table->slots;
    const size_t mask = table->count - 1;
    size_t at = (size_t)(hash / rounds) & mask;
    get_key(job, plan, v, key);
    for (; slots[at].vertex != HEWN_NONE; at = (at + 1) & mask) {
        if (slots[at].hash != (uint32_t)(hash >> 32))
            continue;
        get_key(job, plan, slots[at].vertex, other);
        if (memcmp(key, other, sizeof key) == 0)
            return true;
    }
    slots[at] = (slot){(uint32_t)v, (uint32_t)(hash >> 32)};
    table->used++;
    return false;
}

/* Looks at the vertices whose hash several have and is `round` modulo `rounds`. Ends early where the table is full. */
static hewn_result find_equal(const hewn_writing *job, const hewn_glb_plan *plan, const hash_bits *bits,
                              slot_table *table, uint64_t round, uint64_t rounds, bool *out, hewn_error *error)
{
    const size_t most = table->count - 1;
    memset(table->slots, 0xff, table->count * sizeof *table->slots);
    table->used = 0;
    for (uint64_t begin = 0, end; begin < job->vertex_count && !*out && table->used < most; begin = end) {
        uint64_t hashes[RUN];
        end = hash_run(job, plan, begin, bits->several, bits->mask, hashes);
        for (uint64_t v = begin; v < end && !*out && table->used < most; v++) {
            const uint64_t hash = hashes[v - begin];
            if (has_bit(bits->several, hash & bits->mask) && hash % rounds == round)
                *out = meets_equal(job, plan, table, v, hash, rounds);
            HEWN_TRY(look_up(job, v, error));
        }
    }
    return HEWN_OK;
}

static hewn_result compare_some(const hewn_writing *job, const hewn_glb_plan *plan, const hash_bits *bits, bool *out,
                                hewn_error *error)
{
    size_t count = 16;
    uint64_t needed = 3 * bits->again, rounds = needed / MOST_SLOTS + 1; /* with the first of each, at most twice */
    while (count < needed / rounds + needed / rounds / 16)
        count *= 2;
    slot_table table = {NULL, count / 2, 0};
    hewn_result result = HEWN_OK;
    for (uint64_t round = 0; round < rounds && result == HEWN_OK && !*out;) {
        bool full = !table.slots || table.used == table.count - 1; /* never yet but where hashes are far from even */
        slot *slots = full ? hewn_realloc(table.slots, 2 * table.count, sizeof *slots) : table.slots;
        if (!slots) {
            hewn_free(table.slots);
            return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for writing");
        }
        table = (slot_table){slots, full ? 2 * table.count : table.count, 0};
        result = find_equal(job, plan, bits, &table, round, rounds, out, error);
        round += table.used < table.count - 1;
    }
    hewn_free(table.slots);
    return result;
}

static hewn_result has_equal_positions(const hewn_writing *job, const hewn_glb_plan *plan, bool *out, hewn_error *error)
{
    hash_bits bits;
    *out = false;
    hewn_result result = set_bits(job, plan, &bits, error);
    if (result == HEWN_OK && bits.again > 0)
        result = compare_some(job, plan, &bits, out, error);
    free_bits(&bits);
    return result;
}

/* --- closed manifolds --------------------------------------------------------------------------------------------- */

static int compare(const void *a, const void *b)
{
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* The half-edges of triangles by their lesser vertex: from firsts[v] on, each twice the other vertex and, where that
 * is where it begins, 1. */
typedef struct half_edges {
    uint64_t *firsts; /* vertex_count + 1 */
    uint64_t *ends;
} half_edges;

static void get_half(const hewn_writing *job, uint64_t index, uint32_t out[2])
{
    uint64_t place[3];
    hewn_writing_triangle(job, index / 3, place);
    out[0] = job->corners[place[index % 3]];
    out[1] = job->corners[place[(index + 1) % 3]];
}

static hewn_result collect(const hewn_writing *job, half_edges *to, hewn_error *error)
{
    uint64_t count = 3 * job->triangle_count;
    for (uint64_t i = 0; i < count; i++) {
        uint32_t half[2];
        get_half(job, i, half);
        to->firsts[(half[0] < half[1] ? half[0] : half[1]) + (uint64_t)1]++;
        HEWN_TRY(look_up(job, i, error));
    }
    for (uint64_t v = 0; v < job->vertex_count; v++)
        to->firsts[v + 1] += to->firsts[v];
    for (uint64_t i = count; i-- > 0;) { /* fills each list from its end, so that `firsts` moves to its beginning */
        uint32_t half[2];
        get_half(job, i, half);
        bool back = half[0] > half[1];
        to->ends[--to->firsts[half[back] + (uint64_t)1]] = 2 * (uint64_t)half[!back] + back;
        HEWN_TRY(look_up(job, i, error));
    }
    return HEWN_OK;
}

/* Whether each edge has one triangle on either side. After collect() the list of v begins at firsts[v + 1]. */
static bool is_paired(const hewn_writing *job, const half_edges *halves)
{
    for (uint64_t v = 0; v < job->vertex_count; v++) {
        uint64_t begin = halves->firsts[v + 1];
        uint64_t end = v + 1 < job->vertex_count ? halves->firsts[v + 2] : 3 * job->triangle_count;
        if ((end - begin) % 2 != 0)
            return false;
        qsort(halves->ends + begin, (size_t)(end - begin), sizeof *halves->ends, compare);
        for (uint64_t i = begin; i < end; i += 2) {
            uint64_t there = halves->ends[i], back = halves->ends[i + 1];
            bool pair = there % 2 == 0 && back == there + 1 && there / 2 != v;
            if (!pair || (i > begin && halves->ends[i - 1] / 2 == there / 2))
                return false;
        }
    }
    return true;
}

static hewn_result is_closed_manifold(const hewn_writing *job, bool *out, hewn_error *error)
{
    half_edges halves = {hewn_alloc_zero((size_t)job->vertex_count + 1, sizeof(uint64_t)),
                         hewn_alloc((size_t)job->triangle_count, 3 * sizeof(uint64_t))};
    hewn_result result = halves.firsts && halves.ends
                             ? collect(job, &halves, error)
                             : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for writing");
    *out = result == HEWN_OK && is_paired(job, &halves);
    hewn_free(halves.firsts);
    hewn_free(halves.ends);
    return result;
}

hewn_result hewn_glb_find_topology(const hewn_writing *job, const hewn_glb_plan *plan, hewn_gltf_topology *out,
                                   hewn_error *error)
{
    bool needed = plan->copy_count > 0, closed;
    *out = HEWN_GLTF_NO_TOPOLOGY;
    if (!needed)
        HEWN_TRY(has_equal_positions(job, plan, &needed, error));
    if (!needed)
        return HEWN_OK;
    HEWN_TRY(is_closed_manifold(job, &closed, error));
    *out = closed ? HEWN_GLTF_MANIFOLD : HEWN_GLTF_OWN_TOPOLOGY;
    return HEWN_OK;
}
