/* DICOM: a file with one or several slices, or a folder of slices of one series. Its world is the patient's LPS in mm.
 */
#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/file.h"
#include "base/progress.h"
#include "io/shim/dicom.h"
#include "io/shim/module.h"
#include "io/volume/apart.h"
#include "io/volume/formats.h"

enum { MESSAGE = 256 };

static hewn_result failure_of(hewn_dicom_result result, const char *name, const char *message, hewn_error *error)
{
    return hewn_fail_at(error, result == HEWN_DICOM_OUT_OF_MEMORY ? HEWN_OUT_OF_MEMORY : HEWN_BAD_INPUT, name, 0, "%s",
                        message);
}

static hewn_result find_type(const hewn_dicom_facts *facts, const char *name, hewn_voxel *out, hewn_error *error)
{
    if (!facts->single)
        return hewn_fail_at(error, HEWN_BAD_INPUT, name, 0, "its pixels are colours, not single numbers");
    if (facts->real && facts->bits == 32)
        *out = HEWN_VOXEL_FLOAT;
    else if (facts->real && facts->bits == 64)
        *out = HEWN_VOXEL_DOUBLE;
    else if (!facts->real && facts->bits == 8)
        *out = facts->is_signed ? HEWN_VOXEL_INT8 : HEWN_VOXEL_UINT8;
    else if (!facts->real && facts->bits == 16)
        *out = facts->is_signed ? HEWN_VOXEL_INT16 : HEWN_VOXEL_UINT16;
    else if (!facts->real && facts->bits == 32)
        *out = facts->is_signed ? HEWN_VOXEL_INT32 : HEWN_VOXEL_UINT32;
    else
        return hewn_fail_at(error, HEWN_BAD_INPUT, name, 0, "its pixels are of a size that is not supported");
    return HEWN_OK;
}

/* Everything that the first slice tells; `step` leads from a slice to the next. */
static hewn_result set_head(const hewn_dicom_facts *facts, const char *name, const double step[3], hewn_volume *volume,
                            hewn_error *error)
{
    double columns[3][3];
    HEWN_TRY(find_type(facts, name, &volume->type, error));
    for (int row = 0; row < 3; row++) {
        columns[0][row] = facts->directions[row] * facts->spacing[0];
        columns[1][row] = facts->directions[3 + row] * facts->spacing[1];
        columns[2][row] = step[row];
    }
    hewn_volume_place(volume, columns, facts->origin);
    hewn_volume_turn_world(volume, true, true);
    volume->anatomical = facts->has_place;
    volume->dims[0] = facts->dims[0];
    volume->dims[1] = facts->dims[1];
    volume->dims[2] = facts->dims[2];
    volume->slope = facts->slope;
    volume->intercept = facts->intercept;
    volume->hounsfield = strcmp(facts->modality, "CT") == 0;
    volume->unit = hewn_unit_find("mm");
    return HEWN_OK;
}

static void find_normal(const hewn_dicom_facts *facts, double out[3])
{
    const double *a = facts->directions, *b = facts->directions + 3;
    for (int axis = 0; axis < 3; axis++)
        out[axis] = a[(axis + 1) % 3] * b[(axis + 2) % 3] - a[(axis + 2) % 3] * b[(axis + 1) % 3];
}

static hewn_result read_one(const hewn_volume_source *source, const hewn_dicom_module *module, const hewn_dicom *file,
                            const hewn_dicom_facts *facts, hewn_volume *volume, hewn_error *error)
{
    double step[3];
    char message[MESSAGE];
    size_t bytes;
    find_normal(facts, step);
    for (int axis = 0; axis < 3; axis++) /* a single slice has no next one: any distance will do */
        step[axis] *= facts->dims[2] == 1 && !(facts->spacing[2] > 0) ? 1 : facts->spacing[2];
    HEWN_TRY(set_head(facts, source->name, step, volume, error));
    HEWN_TRY(hewn_volume_head_check(source, volume, &bytes, error));
    HEWN_TRY(hewn_volume_make_room(source, volume, error));
    hewn_dicom_result result = module->pixels(file, volume->memory, bytes, message, sizeof message);
    return result == HEWN_DICOM_OK ? HEWN_OK : failure_of(result, source->name, message, error);
}

hewn_result hewn_dicom_read_here(const hewn_volume_source *source, hewn_volume *out, hewn_error *error)
{
    hewn_dicom *file;
    hewn_dicom_facts facts;
    char message[MESSAGE];
    hewn_volume volume = hewn_volume_blank();
    *out = (hewn_volume){0};
    const hewn_dicom_module *module = hewn_module_load("hewn_dicom", message, sizeof message);
    if (!module)
        return hewn_fail_at(error, HEWN_MISSING_FEATURE, source->name, 0, "%s", message);
    hewn_dicom_result opened = module->open(source->bytes, source->length, &file, &facts, message, sizeof message);
    if (opened != HEWN_DICOM_OK)
        return failure_of(opened, source->name, message, error);
    hewn_result result = read_one(source, module, file, &facts, &volume, error);
    module->close(&file);
    if (result != HEWN_OK) {
        hewn_volume_destroy(&volume);
        return result;
    }
    volume.name = hewn_volume_text(facts.description, strlen(facts.description));
    *out = volume;
    return HEWN_OK;
}

/* --- a folder ----------------------------------------------------------------------------------------------------- */

typedef struct slice {
    char *path;
    char series[80];
    hewn_dicom_facts facts;
    double along; /* the normal of the first slice */
    void *pixels; /* owned */
} slice;

typedef struct series {
    const char *folder;
    const hewn_volume_read_desc *desc;
    const hewn_dicom_module *module;
    slice *slices;
    size_t count, room;
    size_t passed_over; /* files that are no DICOM, or without an image */
    size_t pixel_bytes; /* of all slices so far */
} series;

static void destroy_series(series *all)
{
    for (size_t i = 0; i < all->count; i++) {
        hewn_free(all->slices[i].path);
        hewn_free(all->slices[i].pixels);
    }
    hewn_free(all->slices);
}

/* Adds a file where it is one with an image. */
static hewn_result add_file(series *all, const char *name, hewn_error *error)
{
    struct stat status;
    char *bytes = NULL;
    size_t length, room = strlen(all->folder) + strlen(name) + 2;
    char *path = hewn_alloc(room, 1);
    if (!path)
        return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, all->folder, 0, "out of memory");
    snprintf(path, room, "%s/%s", all->folder, name);
    if (stat(path, &status) != 0 || !S_ISREG(status.st_mode)) {
        hewn_free(path);
        return HEWN_OK;
    }
    slice found = {.path = path};
    void *items = all->slices;
    hewn_result result = hewn_file_read(path, SIZE_MAX / 4, &bytes, &length, error);
    bool dicom =
        result == HEWN_OK && all->module->glance(bytes, length, &found.facts) == HEWN_DICOM_OK && found.facts.has_image;
    hewn_free(bytes);
    if (result == HEWN_OK && dicom)
        result = hewn_reserve(&items, &all->room, all->count + 1, sizeof(slice), error);
    all->slices = items;
    if (result != HEWN_OK || !dicom) {
        all->passed_over += result == HEWN_OK;
        hewn_free(path);
        return result;
    }
    memcpy(found.series, found.facts.series, sizeof found.series);
    all->slices[all->count++] = found;
    return HEWN_OK;
}

static hewn_result list_files(series *all, hewn_error *error)
{
    struct dirent **entries;
    int listed = scandir(all->folder, &entries, NULL, alphasort);
    hewn_result result = HEWN_OK;
    if (listed < 0)
        return hewn_fail_at(error, HEWN_IO, all->folder, 0, "the folder cannot be read");
    for (int i = 0; i < listed; i++) {
        if (result == HEWN_OK && entries[i]->d_name[0] != '.')
            result = add_file(all, entries[i]->d_name, error);
        if (result == HEWN_OK && i % 16 == 0)
            result = hewn_progress_report(all->desc->progress, "load", 0.3 * i / listed, error);
        free(entries[i]);
    }
    free(entries);
    return result;
}

/* Says which series there are, as far as a message has room. */
static hewn_result refuse_several(const series *all, hewn_error *error)
{
    char text[512];
    size_t used = 0, different = 0;
    text[0] = '\0';
    for (size_t i = 0; i < all->count; i++) {
        size_t same = 0;
        for (size_t k = 0; k < all->count; k++) {
            bool equal = strcmp(all->slices[i].series, all->slices[k].series) == 0;
            if (equal && k < i)
                same = SIZE_MAX / 2; /* told already */
            same += equal;
        }
        if (same > all->count)
            continue;
        different++;
        if (used < sizeof text - 160)
            used += (size_t)snprintf(text + used, sizeof text - used, "%s%s (%s, %zu file%s)", used > 0 ? "; " : "",
                                     all->slices[i].series, all->slices[i].facts.modality, same, same == 1 ? "" : "s");
    }
    return hewn_fail_at(error, HEWN_BAD_INPUT, all->folder, 0,
                        "the folder has %zu series; choose one with --series UID: %s", different, text);
}

/* Leaves the slices of the one series that is wanted. */
static hewn_result choose_series(series *all, hewn_error *error)
{
    const char *wanted = all->desc->series;
    size_t kept = 0;
    if (all->count == 0)
        return hewn_fail_at(error, HEWN_BAD_INPUT, all->folder, 0, "no file of the folder is a DICOM image");
    for (size_t i = 1; i < all->count && !wanted; i++)
        if (strcmp(all->slices[i].series, all->slices[0].series) != 0)
            return refuse_several(all, error);
    for (size_t i = 0; i < all->count; i++) {
        if (!wanted || strcmp(all->slices[i].series, wanted) == 0)
            all->slices[kept++] = all->slices[i];
        else
            hewn_free(all->slices[i].path);
    }
    all->count = kept;
    if (kept == 0)
        return hewn_fail_at(error, HEWN_BAD_INPUT, all->folder, 0, "the folder has no series %s", wanted);
    return HEWN_OK;
}

static hewn_result unpack_slice(series *all, slice *one, const hewn_dicom *file, hewn_error *error)
{
    hewn_voxel type;
    char message[MESSAGE];
    const hewn_volume_source limits = {.name = one->path, .desc = all->desc};
    HEWN_TRY(find_type(&one->facts, one->path, &type, error));
    if (one->facts.dims[2] != 1 && all->count > 1)
        return hewn_fail_at(error, HEWN_BAD_INPUT, one->path, 0, "it holds %u frames, but it is one of %zu files",
                            one->facts.dims[2], all->count);
    size_t bytes = (size_t)one->facts.dims[0] * one->facts.dims[1] * one->facts.dims[2] * hewn_voxel_size(type);
    all->pixel_bytes += bytes;
    if (all->pixel_bytes > hewn_volume_limit(&limits))
        return hewn_fail_at(error, HEWN_LIMIT, all->folder, 0, "the slices are over the limit of %llu bytes",
                            (unsigned long long)hewn_volume_limit(&limits));
    one->pixels = hewn_alloc(bytes, 1);
    if (!one->pixels)
        return hewn_fail_at(error, HEWN_OUT_OF_MEMORY, one->path, 0, "out of memory for a slice");
    hewn_dicom_result result = all->module->pixels(file, one->pixels, bytes, message, sizeof message);
    return result == HEWN_DICOM_OK ? HEWN_OK : failure_of(result, one->path, message, error);
}

static hewn_result read_slice(series *all, slice *one, hewn_error *error)
{
    char *bytes, message[MESSAGE];
    size_t length;
    hewn_dicom *file;
    HEWN_TRY(hewn_file_read(one->path, SIZE_MAX / 4, &bytes, &length, error));
    hewn_dicom_result opened = all->module->open(bytes, length, &file, &one->facts, message, sizeof message);
    hewn_free(bytes);
    if (opened != HEWN_DICOM_OK)
        return failure_of(opened, one->path, message, error);
    hewn_result result = unpack_slice(all, one, file, error);
    all->module->close(&file);
    return result;
}

static int compare_slices(const void *a, const void *b)
{
    const slice *one = a, *other = b;
    if (one->along != other->along)
        return one->along < other->along ? -1 : 1;
    return strcmp(one->path, other->path);
}

static hewn_result check_alike(const slice *one, const slice *first, hewn_error *error)
{
    const hewn_dicom_facts *a = &one->facts, *b = &first->facts;
    bool same = a->dims[0] == b->dims[0] && a->dims[1] == b->dims[1] && a->bits == b->bits &&
                a->is_signed == b->is_signed && a->real == b->real;
    if (!same)
        return hewn_fail_at(error, HEWN_BAD_INPUT, one->path, 0, "it has another size or type than the first slice");
    for (int i = 0; i < 6; i++)
        same = same && fabs(a->directions[i] - b->directions[i]) < 1e-4;
    for (int i = 0; i < 2; i++)
        same = same && fabs(a->spacing[i] - b->spacing[i]) < 1e-5 * b->spacing[i];
    if (!same || !a->has_place)
        return hewn_fail_at(error, HEWN_BAD_INPUT, one->path, 0,
                            a->has_place ? "it lies in another direction than the first slice"
                                         : "it does not say where in the patient it lies");
    return HEWN_OK;
}

/* Puts the slices in order and makes sure that they are equally far apart, so that one step leads through all. */
static hewn_result sort_slices(series *all, double step[3], hewn_error *error)
{
    double normal[3];
    find_normal(&all->slices[0].facts, normal);
    for (size_t i = 0; i < all->count; i++) {
        HEWN_TRY(check_alike(&all->slices[i], &all->slices[0], error));
        const double *at = all->slices[i].facts.origin;
        all->slices[i].along = at[0] * normal[0] + at[1] * normal[1] + at[2] * normal[2];
    }
    qsort(all->slices, all->count, sizeof *all->slices, compare_slices);
    const slice *first = &all->slices[0], *last = &all->slices[all->count - 1];
    double mean = (last->along - first->along) / (double)(all->count - 1), least = INFINITY;
    for (size_t i = 1; i < all->count; i++)
        least = fmin(least, all->slices[i].along - all->slices[i - 1].along);
    if (!(least > 1e-4))
        return hewn_fail_at(error, HEWN_BAD_INPUT, all->folder, 0,
                            "two slices lie at the same place: the series holds more than one volume");
    for (size_t i = 1; i < all->count; i++) {
        double gap = all->slices[i].along - all->slices[i - 1].along;
        if (fabs(gap - least) > 0.02 * least && fabs(gap - mean) > 1e-3)
            return hewn_fail_at(error, HEWN_BAD_INPUT, all->slices[i].path, 0,
                                "slices are missing: it is %g mm from the one before, but others are %g mm apart", gap,
                                least);
    }
    for (int axis = 0; axis < 3; axis++) /* slices may be shifted against each other (a tilted gantry) */
        step[axis] = (last->facts.origin[axis] - first->facts.origin[axis]) / (double)(all->count - 1);
    return HEWN_OK;
}

static bool same_scale(const series *all)
{
    for (size_t i = 1; i < all->count; i++)
        if (all->slices[i].facts.slope != all->slices[0].facts.slope ||
            all->slices[i].facts.intercept != all->slices[0].facts.intercept)
            return false;
    return true;
}

/* One slice into its place; as float values where slices are scaled differently (PET). */
static void place_slice(const slice *one, hewn_voxel stored, hewn_volume *volume, size_t k)
{
    size_t count = (size_t)volume->dims[0] * volume->dims[1];
    if (volume->type == stored) {
        size_t bytes = count * hewn_voxel_size(stored);
        memcpy((char *)volume->memory + k * bytes, one->pixels, bytes);
        return;
    }
    const hewn_volume pixels = {.type = stored, .samples = one->pixels};
    float *to = (float *)volume->memory + k * count;
    for (size_t i = 0; i < count; i++)
        to[i] = (float)(one->facts.slope * hewn_volume_sample(&pixels, i) + one->facts.intercept);
}

static hewn_result stack(series *all, const double step[3], hewn_volume *volume, hewn_error *error)
{
    const hewn_volume_source limits = {.name = all->folder, .desc = all->desc};
    HEWN_TRY(set_head(&all->slices[0].facts, all->slices[0].path, step, volume, error));
    hewn_voxel stored = volume->type;
    volume->dims[2] = (uint32_t)all->count;
    if (!same_scale(all)) {
        volume->type = HEWN_VOXEL_FLOAT;
        volume->slope = 1;
        volume->intercept = 0;
    }
    HEWN_TRY(hewn_volume_head_check(&limits, volume, NULL, error));
    HEWN_TRY(hewn_volume_make_room(&limits, volume, error));
    for (size_t k = 0; k < all->count; k++) {
        place_slice(&all->slices[k], stored, volume, k);
        hewn_free(all->slices[k].pixels);
        all->slices[k].pixels = NULL;
    }
    return HEWN_OK;
}

static hewn_result read_series(series *all, hewn_volume *volume, hewn_error *error)
{
    double step[3];
    char message[MESSAGE];
    all->module = hewn_module_load("hewn_dicom", message, sizeof message);
    if (!all->module)
        return hewn_fail_at(error, HEWN_MISSING_FEATURE, all->folder, 0, "%s", message);
    HEWN_TRY(list_files(all, error));
    HEWN_TRY(choose_series(all, error));
    if (all->count == 1) { /* a file of its own: it knows what lies between its frames */
        hewn_volume_source source;
        HEWN_TRY(hewn_volume_source_open(all->slices[0].path, all->desc, &source, error));
        hewn_volume_destroy(volume);
        hewn_result result = hewn_dicom_read_here(&source, volume, error);
        hewn_volume_source_close(&source);
        return result;
    }
    for (size_t i = 0; i < all->count; i++) {
        HEWN_TRY(read_slice(all, &all->slices[i], error));
        HEWN_TRY(hewn_progress_report(all->desc->progress, "load", 0.3 + 0.7 * (double)i / (double)all->count, error));
    }
    HEWN_TRY(sort_slices(all, step, error));
    return stack(all, step, volume, error);
}

hewn_result hewn_dicom_read_folder_here(const char *path, const hewn_volume_read_desc *desc, hewn_volume *out,
                                        hewn_error *error)
{
    series all = {.folder = path, .desc = desc};
    hewn_volume volume = hewn_volume_blank();
    char remark[96];
    *out = (hewn_volume){0};
    hewn_result result = read_series(&all, &volume, error);
    if (result == HEWN_OK && !volume.name)
        volume.name = hewn_volume_text(all.slices[0].facts.description, strlen(all.slices[0].facts.description));
    snprintf(remark, sizeof remark, "%zu files of the folder are no DICOM images and were passed over",
             all.passed_over);
    if (result == HEWN_OK && all.passed_over > 0)
        volume.remark = hewn_strdup(remark);
    destroy_series(&all);
    if (result == HEWN_OK)
        *out = volume;
    else
        hewn_volume_destroy(&volume);
    return result;
}

/* --- apart -------------------------------------------------------------------------------------------------------- */

hewn_result hewn_dicom_read(hewn_volume_source *source, hewn_volume *out, hewn_error *error)
{
    const hewn_apart job = {.reader = HEWN_APART_DICOM,
                            .source = source,
                            .name = source->name,
                            .desc = source->desc,
                            .choice = source->desc->series};
    return hewn_volume_read_apart(&job, out, error);
}

hewn_result hewn_dicom_read_folder(const char *path, const hewn_volume_read_desc *desc, hewn_volume *out,
                                   hewn_error *error)
{
    const hewn_apart job = {.reader = HEWN_APART_DICOM_FOLDER, .name = path, .desc = desc, .choice = desc->series};
    return hewn_volume_read_apart(&job, out, error);
}
