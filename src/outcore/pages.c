#include "outcore/pages.h"

#include <string.h>

#include "base/alloc.h"
#include "base/error.h"

enum { PAGE = 1 << 14 }; /* bytes, about */

static const uint64_t NONE = UINT64_MAX;

/* Where a page of the file may be in memory: only there. */
typedef struct page_slot {
    uint64_t page; /* or NONE */
    bool changed;
} page_slot;

struct hewn_pages {
    hewn_scratch *file;
    size_t size, each; /* bytes of a record, records of a page */
    uint64_t written;  /* pages that the file has */
    size_t slot_count;
    page_slot *slots;
    char *bytes; /* a page a slot */
};

hewn_result hewn_pages_create(const char *output, size_t size, size_t memory, hewn_pages **out, hewn_error *error)
{
    hewn_pages *pages = hewn_alloc_zero(1, sizeof *pages);
    *out = NULL;
    if (!pages)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for pages of a file");
    pages->size = size;
    pages->each = size < PAGE ? PAGE / size : 1;
    pages->slot_count = memory / (pages->each * size) > 4 ? memory / (pages->each * size) : 4;
    pages->slots = hewn_alloc(pages->slot_count, sizeof *pages->slots);
    pages->bytes = hewn_alloc(pages->slot_count, pages->each * size);
    hewn_result result = HEWN_OK;
    if (!pages->slots || !pages->bytes)
        result = hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for pages of a file");
    else
        result = hewn_scratch_create(output, &pages->file, error);
    if (result != HEWN_OK) {
        hewn_pages_destroy(&pages);
        return result;
    }
    for (size_t i = 0; i < pages->slot_count; i++)
        pages->slots[i] = (page_slot){NONE, false};
    *out = pages;
    return HEWN_OK;
}

void hewn_pages_destroy(hewn_pages **pages_place)
{
    hewn_pages *pages = *pages_place;
    if (!pages)
        return;
    hewn_scratch_destroy(&pages->file);
    hewn_free(pages->slots);
    hewn_free(pages->bytes);
    hewn_free(pages);
    *pages_place = NULL;
}

/* Pages up to the one that is written get their zeroes from the file system. */
static hewn_result let_go(hewn_pages *pages, page_slot *slot, const char *bytes, hewn_error *error)
{
    const size_t length = pages->each * pages->size;
    if (slot->page == NONE || !slot->changed)
        return HEWN_OK;
    HEWN_TRY(hewn_scratch_write(pages->file, bytes, length, slot->page * length, error));
    slot->changed = false;
    pages->written = slot->page + 1 > pages->written ? slot->page + 1 : pages->written;
    return HEWN_OK;
}

static hewn_result bring(hewn_pages *pages, uint64_t index, page_slot **slot, char **record, hewn_error *error)
{
    const size_t length = pages->each * pages->size;
    const uint64_t page = index / pages->each;
    const size_t place = (size_t)(page % pages->slot_count);
    char *bytes = pages->bytes + place * length;
    *slot = &pages->slots[place];
    *record = bytes + (size_t)(index % pages->each) * pages->size;
    if ((*slot)->page == page)
        return HEWN_OK;
    HEWN_TRY(let_go(pages, *slot, bytes, error));
    (*slot)->page = NONE;
    if (page < pages->written)
        HEWN_TRY(hewn_scratch_read(pages->file, bytes, length, page * length, error));
    else
        memset(bytes, 0, length);
    (*slot)->page = page;
    return HEWN_OK;
}

hewn_result hewn_pages_get(hewn_pages *pages, uint64_t index, void *record, hewn_error *error)
{
    page_slot *slot;
    char *from;
    HEWN_TRY(bring(pages, index, &slot, &from, error));
    memcpy(record, from, pages->size);
    return HEWN_OK;
}

hewn_result hewn_pages_put(hewn_pages *pages, uint64_t index, const void *record, hewn_error *error)
{
    page_slot *slot;
    char *to;
    HEWN_TRY(bring(pages, index, &slot, &to, error));
    memcpy(to, record, pages->size);
    slot->changed = true;
    return HEWN_OK;
}
