/* Any bytes as a Lua scene: under small limits it must end, in a field that can be evaluated or in an error. */
#include <stdlib.h>
#include <string.h>

#include "scene/scene.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const hewn_scene_setting setting = {"n", 2};
    hewn_scene_desc desc = {.path = "scene.lua",
                            .format = HEWN_SCENE_LUA,
                            .settings = &setting,
                            .setting_count = size % 2, /* with and without one */
                            .instruction_limit = 20000,
                            .memory_limit = (uint64_t)1 << 20};
    char *text = malloc(size + 1);
    if (!text)
        return 0;
    memcpy(text, data, size);
    text[size] = '\0';
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
    } else if (scene || error.code != result || error.message[0] == '\0' ||
               (result != HEWN_BAD_INPUT && result != HEWN_OUT_OF_MEMORY)) {
        abort();
    }
    free(text);
    return 0;
}
