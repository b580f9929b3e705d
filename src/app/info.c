#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/app.h"
#include "app/file_arguments.h"
#include "app/mesh_info.h"
#include "app/path_arguments.h"
#include "app/scene_arguments.h"
#include "app/volume_info.h"
#include "base/error.h"
#include "pipeline/json_parts.h"
#include "pipeline/paths.h"

static const hewn_option options[] = {
    {0, "json", NULL, "Print JSON."},
    {'D', NULL, "NAME=VALUE", "Set a parameter of the scene. May be repeated."},
    {0, "from", "FORMAT",
     "Read the file as lua or vm, as a mesh in glb, gltf, obj, ply, stl or off, or as a volume in nifti, nrrd, "
     "metaimage, "
     "raw, npy, inr, tiff, vdb or dicom. Default: by its extension, else by how it begins; needed where FILE is `-`."},
    {0, "allow-path", NULL, "Let the scene read files outside its own folder."},
    HEWN_OPTIONS_VOLUME,
    {'h', "help", NULL, "Print this help."},
};

/* What is told of a scene's bounds. */
typedef struct found_bounds {
    bool known;
    hewn_box box;
    const char *from; /* "scene" or "field"; NULL where there are none */
    hewn_error reason;
} found_bounds;

static hewn_result find_bounds(const hewn_scene *scene, found_bounds *out, hewn_error *error)
{
    *out = (found_bounds){0};
    if (hewn_scene_bounds(scene, &out->box)) {
        out->known = true;
        out->from = "scene";
        return HEWN_OK;
    }
    const hewn_field *field = hewn_scene_field(scene);
    hewn_result result = hewn_field_find_box(field, hewn_field_root(field), &out->box, &out->reason);
    out->known = result == HEWN_OK;
    out->from = out->known ? "field" : NULL;
    if (result == HEWN_OK || result == HEWN_BAD_INPUT)
        return HEWN_OK;
    *error = out->reason;
    return result;
}

static size_t node_count(const hewn_scene *scene)
{
    const hewn_field *field = hewn_scene_field(scene);
    return hewn_field_size(field, hewn_field_root(field));
}

/* --- text -------------------------------------------------------------------------------------------------------- */

static void print_box(const hewn_box *box)
{
    printf("%g,%g,%g to %g,%g,%g", box->lo[0], box->lo[1], box->lo[2], box->hi[0], box->hi[1], box->hi[2]);
}

static void print_range(const hewn_scene_parameter *parameter)
{
    char range[80];
    if (isfinite(parameter->lo) && isfinite(parameter->hi))
        snprintf(range, sizeof range, "%g to %g", parameter->lo, parameter->hi);
    else if (isfinite(parameter->lo))
        snprintf(range, sizeof range, "from %g", parameter->lo);
    else if (isfinite(parameter->hi))
        snprintf(range, sizeof range, "to %g", parameter->hi);
    else
        snprintf(range, sizeof range, "any");
    printf("  %-16s", range);
    printf("%-6s", parameter->integer ? "whole" : "");
}

static void print_parameters(const hewn_scene *scene)
{
    size_t count = hewn_scene_parameter_count(scene);
    if (count == 0) {
        printf("parameters  none\n");
        return;
    }
    int width = 4;
    for (size_t i = 0; i < count; ++i) {
        int length = (int)strlen(hewn_scene_parameter_at(scene, i)->name);
        width = length > width ? length : width;
    }
    printf("parameters\n  %-*s  %-10s  %-10s  %-22s  %s\n", width, "name", "value", "default", "range", "help");
    for (size_t i = 0; i < count; ++i) {
        const hewn_scene_parameter *parameter = hewn_scene_parameter_at(scene, i);
        printf("  %-*s  %-10g  %-10g", width, parameter->name, parameter->value, parameter->initial);
        print_range(parameter);
        printf("  %s\n", parameter->help ? parameter->help : "");
    }
}

static void print_scene(const char *path, const hewn_scene *scene, const found_bounds *bounds)
{
    printf("%s: scene\n", strcmp(path, "-") == 0 ? "standard input" : path);
    printf("nodes       %zu\n", node_count(scene));
    printf("units       %s (%g m)\n", hewn_scene_unit(scene)->name, hewn_scene_metres_per_unit(scene));
    printf("up          %s\n", hewn_axis_name(hewn_scene_up(scene)));
    printf("bounds      ");
    if (bounds->known) {
        print_box(&bounds->box);
        printf(" (%s)\n", strcmp(bounds->from, "scene") == 0 ? "given by the scene" : "found from the field");
    } else {
        printf("none: %s\n", bounds->reason.message);
    }
    for (size_t i = 0; i < hewn_scene_file_count(scene); ++i)
        printf("%-10s  %s\n", i == 0 ? "files" : "", hewn_scene_file(scene, i));
    print_parameters(scene);
}

/* --- JSON -------------------------------------------------------------------------------------------------------- */

static void json_parameter(hewn_json *json, const hewn_scene_parameter *parameter)
{
    hewn_json_object(json, NULL);
    hewn_json_string(json, "name", parameter->name);
    hewn_json_string(json, "help", parameter->help);
    hewn_json_number(json, "value", parameter->value);
    hewn_json_number(json, "default", parameter->initial);
    hewn_json_array(json, "range");
    hewn_json_number(json, NULL, parameter->lo);
    hewn_json_number(json, NULL, parameter->hi);
    hewn_json_end_array(json);
    hewn_json_bool(json, "integer", parameter->integer);
    hewn_json_end_object(json);
}

static void json_bounds(hewn_json *json, const found_bounds *bounds)
{
    if (bounds->known) {
        hewn_json_box(json, "bounds", &bounds->box);
    } else {
        hewn_json_string(json, "bounds", NULL);
    }
    hewn_json_string(json, "bounds_from", bounds->from);
}

static hewn_result print_scene_json(const char *path, const hewn_scene *scene, const found_bounds *bounds,
                                    hewn_error *error)
{
    hewn_text text = {0};
    hewn_json json = hewn_json_begin(&text);
    hewn_json_object(&json, NULL);
    hewn_json_string(&json, "version", hewn_version());
    hewn_json_string(&json, "input", path);
    hewn_json_array(&json, "files");
    for (size_t i = 0; i < hewn_scene_file_count(scene); ++i)
        hewn_json_string(&json, NULL, hewn_scene_file(scene, i));
    hewn_json_end_array(&json);
    hewn_json_unsigned(&json, "nodes", node_count(scene));
    hewn_json_string(&json, "units", hewn_scene_unit(scene)->name);
    hewn_json_number(&json, "metres_per_unit", hewn_scene_metres_per_unit(scene));
    hewn_json_string(&json, "up", hewn_axis_name(hewn_scene_up(scene)));
    json_bounds(&json, bounds);
    hewn_json_array(&json, "parameters");
    for (size_t i = 0; i < hewn_scene_parameter_count(scene); ++i)
        json_parameter(&json, hewn_scene_parameter_at(scene, i));
    hewn_json_end_array(&json);
    hewn_json_end_object(&json);
    hewn_result result = hewn_text_status(&text, error);
    if (result == HEWN_OK)
        fwrite(text.bytes, 1, text.length, stdout);
    hewn_text_clear(&text);
    return result;
}

/* --- the command ------------------------------------------------------------------------------------------------- */

static hewn_result tell_scene(const hewn_scene_desc *desc, bool json, hewn_error *error)
{
    hewn_scene *scene = NULL;
    HEWN_TRY(hewn_blame_input(hewn_scene_load(desc, &scene, error), desc->path, error));
    found_bounds bounds;
    hewn_result result = find_bounds(scene, &bounds, error);
    if (result == HEWN_OK && json)
        result = print_scene_json(desc->path, scene, &bounds, error);
    else if (result == HEWN_OK)
        print_scene(desc->path, scene, &bounds);
    hewn_scene_destroy(&scene);
    return result;
}

/* Whether the file is to be read as a mesh, and in which format where that is said. */
static bool wants_mesh(const hewn_arguments *arguments, hewn_mesh_format *format)
{
    const char *from = hewn_arguments_value(arguments, "from");
    *format = HEWN_MESH_UNKNOWN;
    if (from)
        return hewn_format_parse(from, "--from", format, NULL) == HEWN_OK;
    return arguments->operand_count > 0 && hewn_mesh_format_of(arguments->operands[0]) != HEWN_MESH_UNKNOWN;
}

static hewn_result run_mesh(const hewn_arguments *arguments, hewn_mesh_format format, hewn_error *error)
{
    const char *path;
    HEWN_TRY(hewn_input_argument_read(arguments, &path, error));
    if (hewn_arguments_has(arguments, "D"))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "-D sets a parameter of a scene, but %s is a mesh", path);
    if (hewn_volume_arguments_any(arguments))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the options of volumes do not go with %s, which is a mesh",
                         path);
    return hewn_mesh_tell(path, format, hewn_arguments_has(arguments, "json"), error);
}

static hewn_result run_volume(const hewn_arguments *arguments, hewn_volume_format format, hewn_error *error)
{
    const char *path;
    hewn_volume_arguments wanted;
    HEWN_TRY(hewn_input_argument_read(arguments, &path, error));
    if (hewn_arguments_has(arguments, "D"))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "-D sets a parameter of a scene, but %s is a volume", path);
    HEWN_TRY(hewn_volume_arguments_read(arguments, &wanted, error));
    wanted.read.format = format;
    return hewn_volume_tell(path, &wanted, hewn_arguments_has(arguments, "json"), error);
}

static hewn_result run_scene(const hewn_arguments *arguments, hewn_error *error)
{
    hewn_scene_arguments scene;
    if (hewn_volume_arguments_any(arguments))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the options of volumes do not go with a scene");
    hewn_result result = hewn_scene_arguments_read(arguments, &scene, error);
    if (result == HEWN_OK)
        result = tell_scene(&scene.desc, hewn_arguments_has(arguments, "json"), error);
    hewn_scene_arguments_destroy(&scene);
    return result;
}

static int run(const hewn_command *command, const hewn_arguments *arguments)
{
    hewn_error error = {0};
    hewn_mesh_format format;
    hewn_volume_format volume;
    hewn_result result = HEWN_OK;
    if (wants_mesh(arguments, &format))
        result = run_mesh(arguments, format, &error);
    else if (hewn_volume_arguments_wanted(arguments, &volume))
        result = run_volume(arguments, volume, &error);
    else
        result = run_scene(arguments, &error);
    return result == HEWN_OK ? 0 : hewn_report_misuse(command, &error);
}

const hewn_command hewn_command_info = {
    .name = "info",
    .summary = "tell what is in a scene, mesh or volume file",
    .usage = "FILE [OPTION]...",
    .about = "Of a scene (.lua, .vm): its parameters with default, value, range and help, its\n"
             "bounds, units, up axis, files and the size of its field. Of a mesh (.glb, .gltf,\n"
             ".obj, .ply, .stl, .off, also with .gz): its counts, unit, axes and attributes,\n"
             "and what `hewn check` finds but for self-intersections. Of a volume (.nii, .hdr,\n"
             ".nrrd, .nhdr, .mha, .mhd, .raw, .npy, .inr, .tif, .vdb, .dcm, also with .gz, or\n"
             "a folder of DICOM): its voxels, their type, place and range. Needs no device.\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .after = "Examples:\n"
             "  hewn info assets/scenes/menger.lua\n"
             "  hewn info bracket.glb --json\n"
             "  hewn info head.nii.gz --iso otsu\n"
             "  hewn info ct.raw --dims 512,512,300 --type int16\n",
    .run = run,
};
