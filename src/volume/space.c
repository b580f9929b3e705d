/* From the lattice to the spaces that meshes are wanted in. */
#include <string.h>
#include <strings.h>

#include "base/error.h"
#include "hewn/volume.h"

static const struct {
    const char *name;
    double axes[9]; /* from RAS */
} spaces[] = {
    [HEWN_SPACE_RAS] = {"ras", {1, 0, 0, 0, 1, 0, 0, 0, 1}},
    [HEWN_SPACE_LPS] = {"lps", {-1, 0, 0, 0, -1, 0, 0, 0, 1}},
    [HEWN_SPACE_VOXEL] = {"voxel", {0}},
    [HEWN_SPACE_GLTF] = {"gltf", {-1, 0, 0, 0, 0, 1, 0, 1, 0}}, /* up is +Y, and who faces the viewer faces +Z */
    [HEWN_SPACE_WORLD] = {"world", {1, 0, 0, 0, 1, 0, 0, 0, 1}}};
#define SPACE_COUNT (sizeof spaces / sizeof *spaces)

const char *hewn_space_name(hewn_space space)
{
    return space > HEWN_SPACE_DEFAULT && (size_t)space < SPACE_COUNT ? spaces[space].name : NULL;
}

bool hewn_space_find(const char *name, hewn_space *out)
{
    for (size_t i = HEWN_SPACE_DEFAULT + 1; i < SPACE_COUNT; i++)
        if (strcasecmp(spaces[i].name, name) == 0) {
            *out = (hewn_space)i;
            return true;
        }
    return false;
}

hewn_result hewn_volume_bring(const hewn_volume *volume, hewn_space space, double scale, double out[16],
                              hewn_error *error)
{
    static const double identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    memcpy(out, identity, sizeof identity);
    if (space == HEWN_SPACE_DEFAULT)
        space = volume->anatomical ? HEWN_SPACE_RAS : HEWN_SPACE_WORLD;
    if (!hewn_space_name(space))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "there is no space number %d", (int)space);
    if (space == HEWN_SPACE_VOXEL)
        return HEWN_OK;
    if (!volume->anatomical && (space == HEWN_SPACE_RAS || space == HEWN_SPACE_LPS))
        return hewn_fail(error, HEWN_BAD_INPUT,
                         "the volume does not say how its axes lie to a patient, so it cannot be brought to %s",
                         space == HEWN_SPACE_RAS ? "RAS" : "LPS");
    const double *axes = volume->anatomical ? spaces[space].axes : spaces[HEWN_SPACE_WORLD].axes;
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 4; column++) {
            double sum = 0;
            for (int k = 0; k < 3; k++)
                if (axes[3 * row + k] != 0) /* nothing is added to what is exact */
                    sum += axes[3 * row + k] * volume->to_world[4 * k + column];
            out[4 * row + column] = scale * sum;
        }
    return HEWN_OK;
}
