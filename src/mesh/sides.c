#include <stdlib.h>

#include "base/alloc.h"
#include "base/error.h"
#include "mesh/soup.h"

/* Rows up to this long are sorted by insertion. */
enum { SHORT_ROW = 24 };

static int compare_keys(const void *a, const void *b)
{
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

static void sort_row(uint64_t *keys, size_t count)
{
    if (count > SHORT_ROW) {
        qsort(keys, count, sizeof *keys, compare_keys);
        return;
    }
    for (size_t i = 1; i < count; i++) {
        uint64_t key = keys[i];
        size_t at = i;
        for (; at > 0 && keys[at - 1] > key; at--)
            keys[at] = keys[at - 1];
        keys[at] = key;
    }
}

/* Rows of the half-edges at their lower vertex: keys hold the higher vertex above the half-edge. */
static void fill_rows(const hewn_soup *soup, uint32_t *row, uint64_t *keys)
{
    for (int pass = 0; pass < 2; pass++) {
        for (uint32_t f = 0; f < soup->face_count; f++)
            for (uint32_t c = (uint32_t)soup->first[f]; c < soup->first[f + 1]; c++) {
                uint32_t a = soup->corners[c], b = soup->corners[hewn_soup_next(soup, f, c)];
                uint32_t low = a < b ? a : b, high = a < b ? b : a;
                if (pass == 0)
                    row[low + 2]++;
                else
                    keys[row[low + 1]++] = (uint64_t)high << 32 | c;
            }
        for (uint32_t v = 0; pass == 0 && v < soup->vertex_count; v++)
            row[v + 2] += row[v + 1];
    }
}

static uint32_t count_groups(const hewn_soup *soup, const uint32_t *row, uint64_t *keys)
{
    uint32_t count = 0;
    for (uint32_t v = 0; v < soup->vertex_count; v++) {
        sort_row(keys + row[v], row[v + 1] - row[v]);
        for (uint32_t i = row[v]; i < row[v + 1]; i++)
            count += i == row[v] || keys[i] >> 32 != keys[i - 1] >> 32;
    }
    return count;
}

hewn_result hewn_sides_build(const hewn_soup *soup, hewn_sides *out, hewn_error *error)
{
    uint32_t corners = hewn_soup_corner_count(soup);
    uint32_t *row = hewn_alloc_zero((size_t)soup->vertex_count + 2, sizeof *row);
    uint64_t *keys = hewn_alloc(corners, sizeof *keys);
    *out = (hewn_sides){.sides = hewn_alloc(corners, sizeof *out->sides), .faces = hewn_soup_corner_faces(soup)};
    bool good = row && keys && out->sides && out->faces;
    if (good) {
        fill_rows(soup, row, keys);
        out->count = count_groups(soup, row, keys);
        out->group = hewn_alloc((size_t)out->count + 1, sizeof *out->group);
        good = out->group != NULL;
    }
    if (good) {
        uint32_t group = 0;
        for (uint32_t v = 0; v < soup->vertex_count; v++)
            for (uint32_t i = row[v]; i < row[v + 1]; i++) {
                if (i == row[v] || keys[i] >> 32 != keys[i - 1] >> 32)
                    out->group[group++] = i;
                out->sides[i] = (uint32_t)keys[i];
            }
        out->group[group] = corners;
    }
    hewn_free(keys);
    hewn_free(row);
    if (good)
        return HEWN_OK;
    hewn_sides_free(out);
    return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory sorting the edges of %u faces", soup->face_count);
}

void hewn_sides_free(hewn_sides *sides)
{
    hewn_free(sides->group);
    hewn_free(sides->sides);
    hewn_free(sides->faces);
    *sides = (hewn_sides){0};
}
