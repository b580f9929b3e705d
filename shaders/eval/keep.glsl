/* Which instructions of a list choices leave, from the last one back. A slot of the list may be needed later on, under a
 * number of the shorter list's; four bits each say so. An operand that replaces its combination takes over its number. */
const uint FIELD_NONE = 15u;

uint field_number(uvec2 map, uint slot)
{
    uint half_of = slot < 8u ? map.x : map.y;
    return half_of >> 4u * (slot & 7u) & 15u;
}

uvec2 field_renumbered(uvec2 map, uint slot, uint number)
{
    uint shift = 4u * (slot & 7u), change = (field_number(map, slot) ^ number) << shift;
    return slot < 8u ? uvec2(map.x ^ change, map.y) : uvec2(map.x, map.y ^ change);
}

struct Keeping {
    uvec2 map; /* the shorter list's number of a slot that is needed, or FIELD_NONE */
    uint used; /* numbers in use, a bit each */
};

/* At a list's end: the root is in slot 0 and goes there. */
Keeping field_keeping()
{
    return Keeping(uvec2(0xFFFFFFF0u, 0xFFFFFFFFu), 1u);
}

/* Sees to it that a slot's value is made, under the lowest free number if it has none. */
uint field_ask(inout Keeping state, uint slot)
{
    uint number = FIELD_NONE;
    if (slot != FIELD_NONE) {
        number = field_number(state.map, slot);
        if (number == FIELD_NONE) {
            number = uint(findLSB(~state.used));
            state.map = field_renumbered(state.map, slot, number);
            state.used |= 1u << number;
        }
    }
    return number;
}

/* Whether an instruction is kept, and its head then. Choice 1: only a matters; 2: only what its body gives. */
#if FIELD_SLOTS == 1
/* One value is made after the other, and only whether it is still needed has to be known. */
bool field_keeps(inout Keeping state, uint head, uint choice, out uint made)
{
    bool copies = (head & 255u) == 0u, alone = choice == 2u;
    bool keeps = state.used != 0u && choice != 1u && !(alone && copies);
    made = alone ? (head & 0xFFF0F0FFu) | 0x000F0000u : head;
    state.used = keeps && made >> 16 == 0xFFFFu ? 0u : state.used;
    return keeps;
}
#else
bool field_keeps(inout Keeping state, uint head, uint choice, out uint made)
{
    uint out_slot = head >> 12 & 15u, number = field_number(state.map, out_slot);
    made = 0u;
    if (number == FIELD_NONE)
        return false;
    uint a = head >> 16 & 15u, b = head >> 20 & 15u;
    state.map = field_renumbered(state.map, out_slot, FIELD_NONE);
    state.used &= ~(1u << number);
    bool copies = (head & 255u) == 0u;
    uint only = choice == 1u ? a : choice == 2u && copies ? b : FIELD_NONE;
    uint body = head & 255u, how = choice == 2u ? 0u : head >> 8 & 15u;
    uint from_a = FIELD_NONE, from_b = FIELD_NONE, from_c = FIELD_NONE, from_d = FIELD_NONE;
    if (only != FIELD_NONE) {
        from_b = field_number(state.map, only);
        if (from_b == FIELD_NONE) { /* nobody else wants it: it takes the number over */
            state.map = field_renumbered(state.map, only, number);
            state.used |= 1u << number;
            return false;
        }
        body = 0u;
        how = 0u;
    } else {
        if (how != 0u)
            from_a = field_ask(state, a);
        from_b = field_ask(state, b);
        from_c = field_ask(state, head >> 24 & 15u);
        from_d = field_ask(state, head >> 28);
    }
    made = body | how << 8 | number << 12 | from_a << 16 | from_b << 20 | from_c << 24 | from_d << 28;
    return true;
}
#endif
