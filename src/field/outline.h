/* Outlines read back from their chains of links (graph.h). */
#ifndef HEWN_SRC_FIELD_OUTLINE_H
#define HEWN_SRC_FIELD_OUTLINE_H

#include "field/graph.h"

/* How many sides the chain of an outline has; 0 where its links are of other coordinates than the outline, or do not go
 * back to the start: then it is nothing but its operations. */
uint32_t hewn_outline_count(const hewn_field *field, const hewn_node_data *outline);

/* The sides (ax, ay, bx, by) in the order of the chain, as many as hewn_outline_count() tells. */
void hewn_outline_sides(const hewn_field *field, const hewn_node_data *outline, double (*sides)[4]);

#endif
