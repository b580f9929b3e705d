#include "heap.h"

#include <stdlib.h>

#include "field/graph.h"

static bool read_shape(const hewn_field *field, uint32_t id, dense_shape *out)
{
    const hewn_node_data *node = hewn_field_node(field, id);
    switch (node->op) {
    case HEWN_OP_SPHERE: out->kind = DENSE_BALL; break;
    case HEWN_OP_BOX: out->kind = DENSE_BOX; break;
    case HEWN_OP_TORUS: out->kind = DENSE_RING; break;
    default: return false;
    }
    for (int k = 0; k < 3; k++) {
        const hewn_node_data *row = hewn_field_node(field, node->operand[k]);
        if (row->op != HEWN_OP_AFFINE)
            return false;
        for (int i = 0; i < 4; i++)
            out->frame[k][i] = (float)row->parameter[i];
        out->size[k] = (float)node->parameter[k];
    }
    return true;
}

dense_shape *heap_read(const hewn_field *field, size_t *count)
{
    uint32_t at = hewn_field_root(field).id, shapes = 1;
    for (uint32_t id = at; hewn_field_node(field, id)->op == HEWN_OP_BLEND_QUADRATIC;
         id = hewn_field_node(field, id)->operand[0])
        shapes++;
    dense_shape *heap = calloc(shapes, sizeof *heap);
    for (uint32_t i = shapes; heap && i-- > 0;) {
        const hewn_node_data *node = hewn_field_node(field, at);
        bool melts = i > 0;
        if (!read_shape(field, melts ? node->operand[1] : at, &heap[i])) {
            free(heap);
            return NULL;
        }
        heap[i].melt = melts ? (float)node->parameter[0] : 1e-6f;
        at = melts ? node->operand[0] : at;
    }
    *count = shapes;
    return heap;
}
