/* Build tool: writes a file as a C array of bytes. usage: embed INPUT OUTPUT.c NAME [INCLUDE_FOLDER]
 * NAME[] is aligned for SPIR-V words and has a NUL after its NAME_size bytes, so that text can be used as a string.
 * With a folder, lines `#include "file"` are replaced by that file of the folder, since shaders completed at run time
 * have no files to include. */
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

typedef struct writer {
    FILE *out;
    const char *folder;
    size_t size;
} writer;

static void write_byte(writer *writer, int byte)
{
    fprintf(writer->out, "%s%d,", writer->size % 24 == 0 ? "\n" : "", byte);
    writer->size++;
}

static bool write_file(writer *writer, const char *path);

/* True where the line was an include, which is then written in its place. */
static bool write_include(writer *writer, const char *line, bool *failed)
{
    char name[256], path[1024];
    if (!writer->folder || sscanf(line, " # include \"%255[^\"]\"", name) != 1)
        return false;
    snprintf(path, sizeof path, "%s/%s", writer->folder, name);
    *failed = !write_file(writer, path);
    return true;
}

static bool write_file(writer *writer, const char *path)
{
    FILE *in = fopen(path, "rb");
    if (!in) {
        perror(path);
        return false;
    }
    bool failed = false;
    if (writer->folder) {
        for (char line[4096]; !failed && fgets(line, sizeof line, in);)
            if (!write_include(writer, line, &failed))
                for (const char *at = line; *at; at++)
                    write_byte(writer, (unsigned char)*at);
    } else {
        for (int byte; (byte = getc(in)) != EOF;)
            write_byte(writer, byte);
    }
    fclose(in);
    return !failed;
}

int main(int argc, char **argv)
{
    if (argc != 4 && argc != 5) {
        fprintf(stderr, "usage: embed INPUT OUTPUT.c NAME [INCLUDE_FOLDER]\n");
        return 2;
    }
    writer writer = {.out = fopen(argv[2], "wb"), .folder = argc == 5 ? argv[4] : NULL};
    if (!writer.out) {
        perror(argv[2]);
        return 1;
    }
    const char *name = argv[3];
    fprintf(writer.out, "#include <stddef.h>\nextern const unsigned char %s[];\nextern const size_t %s_size;\n", name,
            name);
    fprintf(writer.out, "_Alignas(4) const unsigned char %s[] = {", name);
    bool done = write_file(&writer, argv[1]);
    fprintf(writer.out, "\n0};\nconst size_t %s_size = %zu;\n", name, writer.size);
    return fclose(writer.out) == 0 && done ? 0 : 1;
}
