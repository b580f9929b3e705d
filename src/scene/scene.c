#include "scene/scene.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/file.h"
#include "base/text.h"

hewn_result hewn_scene_add_source(hewn_scene *scene, char *path, char *real, hewn_error *error)
{
    void *items = scene->sources;
    hewn_result result =
        path ? hewn_reserve(&items, &scene->source_capacity, scene->source_count + 1, sizeof *scene->sources, error)
             : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory loading a scene");
    if (result != HEWN_OK) {
        hewn_free(path);
        hewn_free(real);
        return result;
    }
    scene->sources = items;
    scene->sources[scene->source_count++] = (hewn_scene_source){path, real};
    return HEWN_OK;
}

/* --- what must hold before and after a front end runs ------------------------------------------------------------ */

static hewn_result check_settings(const hewn_scene_desc *desc, hewn_error *error)
{
    for (size_t i = 0; i < desc->setting_count; i++) {
        const char *name = desc->settings[i].name;
        if (!name || name[0] == '\0')
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "a setting has no name");
        if (!isfinite(desc->settings[i].value))
            return hewn_fail(error, HEWN_BAD_INPUT, "the value of parameter '%s' is not a finite number", name);
        for (size_t j = 0; j < i; j++)
            if (strcmp(name, desc->settings[j].name) == 0)
                return hewn_fail(error, HEWN_BAD_INPUT, "parameter '%s' is set twice", name);
    }
    return HEWN_OK;
}

/* A setting that no param() asked for is a slip of the pen: say what could have been meant. */
static hewn_result check_settings_known(const hewn_scene *scene, const hewn_scene_desc *desc, hewn_error *error)
{
    for (size_t i = 0; i < desc->setting_count; i++) {
        bool known = false;
        for (size_t j = 0; j < scene->parameter_count; j++)
            known = known || strcmp(desc->settings[i].name, scene->parameters[j].name) == 0;
        if (known)
            continue;
        hewn_text names = {0};
        for (size_t j = 0; j < scene->parameter_count; j++) {
            hewn_text_append(&names, j ? ", " : "");
            hewn_text_append(&names, scene->parameters[j].name);
        }
        char shown[64];
        hewn_text_clean(shown, sizeof shown, desc->settings[i].name, strlen(desc->settings[i].name));
        hewn_result result = hewn_fail_at(error, HEWN_BAD_INPUT, scene->sources[0].path, 0,
                                          "there is no parameter '%s'; the scene's parameters are: %s", shown,
                                          names.length ? names.bytes : "none");
        hewn_text_clear(&names);
        return result;
    }
    return HEWN_OK;
}

static hewn_result find_format(const hewn_scene_desc *desc, hewn_scene_format *format, hewn_error *error)
{
    *format = desc->format;
    if (*format == HEWN_SCENE_LUA || *format == HEWN_SCENE_VM)
        return HEWN_OK;
    if (*format != HEWN_SCENE_BY_NAME)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "no scene format has the number %d", (int)*format);
    if (strcmp(desc->path, "-") == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "say which format standard input has: lua or vm");
    const char *slash = strrchr(desc->path, '/');
    const char *dot = strrchr(slash ? slash : desc->path, '.');
    if (dot && strcasecmp(dot, ".lua") == 0)
        *format = HEWN_SCENE_LUA;
    else if (dot && strcasecmp(dot, ".vm") == 0)
        *format = HEWN_SCENE_VM;
    else
        return hewn_fail_at(error, HEWN_INVALID_ARGUMENT, desc->path, 0,
                            "not a scene by its name: a scene ends in .lua or .vm");
    return HEWN_OK;
}

static hewn_result run_vm(hewn_scene *scene, const char *text, size_t length, hewn_error *error)
{
    hewn_node root;
    HEWN_TRY(hewn_vm_parse(scene->field, scene->sources[0].path, text, length, &root, error));
    scene->has_bounds = true; /* the models of this format are drawn in the cube of +-1 */
    for (int i = 0; i < 3; i++) {
        scene->bounds.lo[i] = -1;
        scene->bounds.hi[i] = 1;
    }
    return hewn_field_set_root(scene->field, root, error);
}

static hewn_result run_lua(hewn_scene *scene, const hewn_scene_desc *desc, const char *text, size_t length,
                           hewn_error *error)
{
    hewn_lua_limits limits = {
        .instructions = desc->instruction_limit ? desc->instruction_limit : 200000000u,
        .memory = desc->memory_limit ? desc->memory_limit : (uint64_t)256 << 20,
    };
    if (!desc->allow_path) {
        scene->root = hewn_path_real_folder(desc->path);
        if (!scene->root)
            return hewn_fail_at(error, HEWN_IO, desc->path, 0, "cannot find the scene's folder: %s", strerror(errno));
    }
    hewn_result result = hewn_lua_run(scene, &limits, text, length, error);
    hewn_free(scene->root);
    scene->root = NULL;
    return result;
}

static hewn_result fill(hewn_scene *scene, const hewn_scene_desc *desc, hewn_scene_format format, const char *text,
                        size_t length, hewn_error *error)
{
    bool standard = strcmp(desc->path, "-") == 0;
    HEWN_TRY(hewn_field_create(&scene->field, error));
    HEWN_TRY(hewn_scene_add_source(scene, hewn_strdup(standard ? "<stdin>" : desc->path),
                                   standard ? NULL : hewn_path_real(desc->path), error));
    scene->settings = desc->settings;
    scene->setting_count = desc->setting_count;
    scene->reader = desc->reader;
    hewn_result result =
        format == HEWN_SCENE_VM ? run_vm(scene, text, length, error) : run_lua(scene, desc, text, length, error);
    scene->settings = NULL;
    scene->setting_count = 0;
    scene->reader = NULL;
    HEWN_TRY(result);
    return check_settings_known(scene, desc, error);
}

hewn_result hewn_scene_load_text(const hewn_scene_desc *desc, const char *text, size_t length, hewn_scene **out,
                                 hewn_error *error)
{
    hewn_scene_format format;
    *out = NULL;
    HEWN_TRY(find_format(desc, &format, error));
    HEWN_TRY(check_settings(desc, error));
    hewn_scene *scene = hewn_alloc_zero(1, sizeof *scene);
    if (!scene)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory loading a scene");
    hewn_result result = fill(scene, desc, format, text, length, error);
    if (result != HEWN_OK) {
        hewn_scene_destroy(&scene);
        return result;
    }
    *out = scene;
    return HEWN_OK;
}

hewn_result hewn_scene_load(const hewn_scene_desc *desc, hewn_scene **out, hewn_error *error)
{
    hewn_scene_format format;
    char *text = NULL;
    size_t length = 0;
    *out = NULL;
    if (!desc->path || desc->path[0] == '\0')
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the scene has no path");
    if (desc->setting_count && !desc->settings)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "there are settings to read, but no array of them");
    HEWN_TRY(find_format(desc, &format, error));
    HEWN_TRY(hewn_file_read(desc->path, HEWN_SCENE_FILE_LIMIT, &text, &length, error));
    hewn_result result = hewn_scene_load_text(desc, text, length, out, error);
    hewn_free(text);
    return result;
}

void hewn_scene_destroy(hewn_scene **scene)
{
    hewn_scene *s = *scene;
    if (!s)
        return;
    for (size_t i = 0; i < s->parameter_count; i++) {
        hewn_free((char *)s->parameters[i].name);
        hewn_free((char *)s->parameters[i].help);
    }
    for (size_t i = 0; i < s->source_count; i++) {
        hewn_free(s->sources[i].path);
        hewn_free(s->sources[i].real);
    }
    for (size_t i = 0; i < s->sampling_count; i++) {
        hewn_free(s->samplings[i].report.path);
        hewn_free(s->samplings[i].real);
        hewn_sampling_destroy(&s->samplings[i].sampling);
    }
    hewn_free(s->samplings);
    hewn_free(s->parameters);
    hewn_free(s->sources);
    hewn_free(s->root);
    hewn_field_destroy(&s->field);
    hewn_free(s);
    *scene = NULL;
}

/* --- asking ------------------------------------------------------------------------------------------------------ */

const hewn_field *hewn_scene_field(const hewn_scene *scene)
{
    return scene->field;
}

size_t hewn_scene_parameter_count(const hewn_scene *scene)
{
    return scene->parameter_count;
}

const hewn_scene_parameter *hewn_scene_parameter_at(const hewn_scene *scene, size_t index)
{
    return index < scene->parameter_count ? &scene->parameters[index] : NULL;
}

bool hewn_scene_bounds(const hewn_scene *scene, hewn_box *out)
{
    *out = scene->has_bounds ? scene->bounds : (hewn_box){0};
    return scene->has_bounds;
}

double hewn_scene_metres_per_unit(const hewn_scene *scene)
{
    return hewn_unit_metres(hewn_scene_unit(scene));
}

const hewn_unit *hewn_scene_unit(const hewn_scene *scene)
{
    return scene->unit ? scene->unit : hewn_unit_at(0);
}

hewn_axis hewn_scene_up(const hewn_scene *scene)
{
    return scene->up;
}

size_t hewn_scene_file_count(const hewn_scene *scene)
{
    return scene->source_count;
}

size_t hewn_scene_sampled_count(const hewn_scene *scene)
{
    return scene->sampling_count;
}

const hewn_scene_sampled *hewn_scene_sampled_at(const hewn_scene *scene, size_t index)
{
    return index < scene->sampling_count ? &scene->samplings[index].report : NULL;
}

const char *hewn_scene_file(const hewn_scene *scene, size_t index)
{
    return index < scene->source_count ? scene->sources[index].path : NULL;
}
