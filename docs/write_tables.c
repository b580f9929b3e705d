/* Writes the tables of docs/scene.md anew from the catalogue of functions: what stands between a line
 * "<!-- table: NAME -->" and the next "<!-- end -->". Takes the file's path; leaves it alone where nothing changes.
 * With --names it prints the functions' names, for draw_pictures.sh. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "field/catalogue.h"

static char *read_all(const char *path)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        return NULL;
    hewn_text text = {0};
    char block[4096];
    for (size_t count; (count = fread(block, 1, sizeof block, file)) > 0;)
        hewn_text_append_bytes(&text, block, count);
    fclose(file);
    return text.bytes;
}

int main(int count, char **arguments)
{
    static const char end[] = "<!-- end -->";
    if (count == 2 && strcmp(arguments[1], "--names") == 0) {
        for (size_t i = 0; i < hewn_function_count; i++)
            puts(hewn_functions[i].name);
        return 0;
    }
    char *old = count == 2 ? read_all(arguments[1]) : NULL;
    if (!old) {
        fprintf(stderr, "usage: write_tables docs/scene.md | --names\n");
        return 2;
    }
    hewn_text made = {0};
    const char *at = old;
    for (int section = 0; section < HEWN_SECTIONS; section++) {
        char begin[80];
        snprintf(begin, sizeof begin, "<!-- table: %s -->\n", hewn_section_name((hewn_section)section));
        const char *start = strstr(at, begin), *stop = start ? strstr(start, end) : NULL;
        if (!stop) {
            fprintf(stderr, "write_tables: %s has no '%.40s' where it is looked for\n", arguments[1], begin);
            return 1;
        }
        start += strlen(begin);
        hewn_text_append_bytes(&made, at, (size_t)(start - at));
        hewn_catalogue_write((hewn_section)section, &made);
        at = stop;
    }
    hewn_text_append(&made, at);
    FILE *file = made.failed || strcmp(old, made.bytes) == 0 ? NULL : fopen(arguments[1], "wb");
    bool written = !file || fwrite(made.bytes, 1, made.length, file) == made.length;
    if (file && fclose(file) != 0)
        written = false;
    free(old);
    hewn_text_clear(&made);
    return written ? 0 : 1;
}
