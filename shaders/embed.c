/* Build tool: writes a file as a C array of bytes. usage: embed INPUT OUTPUT.c NAME
 * NAME[] is aligned for SPIR-V words and has a NUL after its NAME_size bytes, so that text can be used as a string. */
#include <stdio.h>

int main(int argc, char **argv)
{
    if (argc != 4) {
        fprintf(stderr, "usage: embed INPUT OUTPUT.c NAME\n");
        return 2;
    }
    FILE *in = fopen(argv[1], "rb");
    FILE *out = fopen(argv[2], "wb");
    if (!in || !out) {
        perror(in ? argv[2] : argv[1]);
        return 1;
    }
    fprintf(out, "#include <stddef.h>\n_Alignas(4) extern const unsigned char %s[];\nextern const size_t %s_size;\n",
            argv[3], argv[3]);
    fprintf(out, "_Alignas(4) const unsigned char %s[] = {", argv[3]);
    size_t size = 0;
    for (int byte; (byte = getc(in)) != EOF; size++)
        fprintf(out, "%s%d,", size % 24 == 0 ? "\n" : "", byte);
    fprintf(out, "\n0};\nconst size_t %s_size = %zu;\n", argv[3], size);
    fclose(in);
    return fclose(out) == 0 ? 0 : 1;
}
