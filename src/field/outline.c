#include "field/outline.h"

#include <string.h>

/* The link before one, where it is of the same coordinates. */
static const hewn_node_data *link_before(const hewn_field *field, const hewn_node_data *link)
{
    const hewn_node_data *before = hewn_field_node(field, link->operand[0]);
    bool same = before->operand[1] == link->operand[1] && before->operand[2] == link->operand[2];
    return before->op == HEWN_OP_EDGE && same ? before : NULL;
}

uint32_t hewn_outline_count(const hewn_field *field, const hewn_node_data *outline)
{
    const hewn_node_data *first = outline;
    uint32_t count = 0;
    for (const hewn_node_data *link = outline; (link = link_before(field, link)) != NULL; first = link)
        count++;
    if (count == 0)
        return 0;
    const hewn_node_data *start = hewn_field_node(field, first->operand[0]);
    return start->op == HEWN_OP_CONSTANT && start->parameter[0] == HEWN_OUTLINE_START ? count : 0;
}

void hewn_outline_sides(const hewn_field *field, const hewn_node_data *outline, double (*sides)[4])
{
    uint32_t at = hewn_outline_count(field, outline);
    for (const hewn_node_data *link = outline; (link = link_before(field, link)) != NULL;)
        memcpy(sides[--at], link->parameter, sizeof sides[0]);
}
