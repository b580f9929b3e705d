/* Runs a fuzzer without libFuzzer: over every seed and over seeded mutations of them, so that the same inputs come on
 * every run. A crash is the failure. TAP on standard output. Usage: fuzz_NAME FOLDER-OF-SEEDS. */
#include <dirent.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { MAX_SEEDS = 256, MAX_BYTES = 1 << 20, MUTATIONS = 2000, MUTATIONS_LONG = 200000 };

typedef struct seed {
    uint8_t *bytes;
    size_t size;
} seed;

static uint64_t next_random(uint64_t *state) /* xorshift64 of Marsaglia 2003 */
{
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    return *state;
}

/* Adds a folder's files to the `count` seeds there are, and returns how many there are then. */
static size_t load_seeds(const char *folder, seed seeds[MAX_SEEDS], size_t count)
{
    struct dirent **entries;
    int listed = scandir(folder, &entries, NULL, alphasort); /* sorted: the same order everywhere */
    for (int i = 0; i < listed; i++) {
        char path[4096];
        snprintf(path, sizeof path, "%s/%s", folder, entries[i]->d_name);
        FILE *file = entries[i]->d_name[0] != '.' && count < MAX_SEEDS ? fopen(path, "rb") : NULL;
        free(entries[i]);
        if (file == NULL)
            continue;
        seeds[count].bytes = malloc(MAX_BYTES);
        if (seeds[count].bytes == NULL)
            abort();
        seeds[count].size = fread(seeds[count].bytes, 1, MAX_BYTES, file);
        count++;
        fclose(file);
    }
    if (listed >= 0)
        free(entries);
    return count;
}

/* A few edits: a byte changed, a stretch removed, repeated, or taken from another seed. Returns the new size. */
static size_t mutate(uint8_t *bytes, size_t size, const seed *other, uint64_t *random)
{
    for (uint64_t edits = 1 + next_random(random) % 4; edits > 0 && size > 0; edits--) {
        size_t at = next_random(random) % size;
        size_t length = 1 + next_random(random) % 16;
        if (length > size - at)
            length = size - at;
        switch (next_random(random) % 4) {
        case 0: bytes[at] ^= (uint8_t)(1u << next_random(random) % 8); break;
        case 1:
            memmove(bytes + at, bytes + at + length, size - at - length);
            size -= length;
            break;
        case 2:
            if (size + length <= MAX_BYTES) {
                memmove(bytes + at + length, bytes + at, size - at);
                size += length;
            }
            break;
        default:
            for (size_t i = 0; i < length && other->size > 0; i++)
                bytes[at + i] = other->bytes[(at + i) % other->size];
        }
    }
    return size;
}

/* In a block of its own size, so that the address sanitizer sees a read past the end. */
static void run(const uint8_t *bytes, size_t size)
{
    uint8_t *exact = malloc(size > 0 ? size : 1);
    if (exact == NULL)
        abort();
    memcpy(exact, bytes, size);
    LLVMFuzzerTestOneInput(exact, size);
    free(exact);
}

int main(int count, char **arguments)
{
    static seed seeds[MAX_SEEDS];
    size_t seed_count = 0;
    for (int i = 1; i < count; i++)
        seed_count = load_seeds(arguments[i], seeds, seed_count);
    uint8_t *bytes = malloc(MAX_BYTES);
    uint64_t random = 88172645463325252u;
    uint64_t mutations = getenv("HEWN_LONG") != NULL ? MUTATIONS_LONG : MUTATIONS;

    printf("1..2\n%s 1 - %zu seeds\n", seed_count > 0 ? "ok" : "not ok", seed_count);
    fflush(stdout);
    if (bytes == NULL)
        abort();
    if (seed_count == 0) {
        free(bytes);
        return 1;
    }
    for (size_t i = 0; i < seed_count; i++)
        run(seeds[i].bytes, seeds[i].size);
    for (uint64_t i = 0; i < mutations; i++) {
        const seed *from = &seeds[next_random(&random) % seed_count];
        const seed *other = &seeds[next_random(&random) % seed_count];
        memcpy(bytes, from->bytes, from->size);
        run(bytes, mutate(bytes, from->size, other, &random));
    }
    printf("ok 2 - %llu mutations\n", (unsigned long long)mutations);
    for (size_t i = 0; i < seed_count; i++)
        free(seeds[i].bytes);
    free(bytes);
    return 0;
}
