/* Any bytes as a .vm scene: a field that can be evaluated, or an error that names a line of the text. */
#include <stdlib.h>
#include <string.h>

#include "scene/scene.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    hewn_scene_desc desc = {.path = "scene.vm"};
    char *text = malloc(size + 1);
    if (!text)
        return 0;
    memcpy(text, data, size);
    text[size] = '\0';
    uint32_t lines = 1;
    for (size_t i = 0; i < size; i++)
        lines += text[i] == '\n';
    hewn_scene *scene;
    hewn_error error = {0};
    hewn_result result = hewn_scene_load_text(&desc, text, size, &scene, &error);
    if (result == HEWN_OK) {
        const double points[] = {0, 0, 0, 1.5, -0.25, 3};
        double values[2];
        const hewn_field *field = hewn_scene_field(scene);
        if (hewn_field_eval(field, hewn_field_root(field), points, 2, values, NULL) != HEWN_OK)
            abort();
        hewn_scene_destroy(&scene);
    } else if (scene || result != HEWN_BAD_INPUT || error.message[0] == '\0' || error.line > lines) {
        abort();
    }
    free(text);
    return 0;
}
