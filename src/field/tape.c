#include "base/alloc.h"
#include "base/error.h"
#include "field/internal.h"

hewn_result hewn_tape_create(hewn_tape *tape, const hewn_field *field, hewn_node root, hewn_error *error)
{
    *tape = (hewn_tape){0};
    uint32_t *ids = NULL;
    size_t count = 0;
    HEWN_TRY(hewn_field_live_nodes(field, root, &ids, &count, error));
    hewn_step *steps = hewn_alloc(count, sizeof *steps);
    uint32_t *position = hewn_alloc((size_t)root.id + 1, sizeof *position); /* set for live ids only */
    if (!steps || !position) {
        hewn_free(ids);
        hewn_free(steps);
        hewn_free(position);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory evaluating a field of %zu nodes", count);
    }
    size_t made = 0;
    for (size_t i = 0; i < count; i++) {
        const hewn_node_data *node = &field->nodes[ids[i]];
        if (node->op == HEWN_OP_PAINT) {
            position[ids[i]] = position[node->operand[0]];
            continue;
        }
        position[ids[i]] = (uint32_t)made;
        hewn_step *step = &steps[made++];
        *step = (hewn_step){node, {HEWN_NO_ID, HEWN_NO_ID, HEWN_NO_ID}};
        for (int k = 0; k < hewn_op_infos[node->op].operands; k++)
            step->in[k] = position[node->operand[k]];
    }
    hewn_free(ids);
    hewn_free(position);
    tape->steps = steps;
    tape->count = made;
    return HEWN_OK;
}

void hewn_tape_destroy(hewn_tape *tape)
{
    hewn_free(tape->steps);
    *tape = (hewn_tape){0};
}
