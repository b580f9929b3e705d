/* The attributes of a model as wedges, and back. */
#ifndef HEWN_SRC_SIMPLIFY_CHANNELS_H
#define HEWN_SRC_SIMPLIFY_CHANNELS_H

#include "hewn/model.h"
#include "simplify/run.h"

/* Wedges with owned arrays, and where each channel's scalars are among a wedge's: `first` has one entry a channel of
 * the model, HEWN_NONE for what is not carried that way (faces; what is dropped or made anew). */
typedef struct simplify_channels {
    simplify_wedges wedges;
    uint32_t *first;
    uint32_t *corners;
} simplify_channels;

/* `preserve` says which attributes count in the error, and which differences make seams. `wedges` of the result has no
 * scalars where the model has nothing to carry. HEWN_OUT_OF_MEMORY, HEWN_LIMIT for too many scalars that count. */
hewn_result hewn_simplify_take_channels(const hewn_model *model, uint32_t preserve, simplify_channels *out,
                                        hewn_error *error);
void hewn_simplify_release_channels(simplify_channels *channels);

/* Fills in the channels of a result, which has its positions and corners already, from those of `from`. */
hewn_result hewn_simplify_give_channels(const hewn_model *from, const simplify_channels *channels,
                                        const simplify_result *result, hewn_model *out, hewn_error *error);

/* Makes channels "normal" anew: of vertices from all faces around, of corners from those that bend little from their
 * own, so that edges stay sharp. HEWN_OUT_OF_MEMORY. */
hewn_result hewn_simplify_renew_normals(hewn_model *model, hewn_error *error);

/* A number a face that is equal where all labels that `preserve` names are; NULL where there are none. */
hewn_result hewn_simplify_join_labels(const hewn_model *model, uint32_t preserve, int32_t **out, hewn_error *error);

#endif
