/* Applies the choices of a box to the selected list. Two bits an instruction, sixteen a word. */
uint field_keep(hewn_words choices, uint first, bool write, hewn_words to, uint end)
{
    hewn_words list = hewn_words(field_list);
    Keeping state = field_keeping();
    uint kept = 0u, left = field_end - field_begin;
    while (left > 0u && state.used != 0u) {
        uint word = (left - 1u) >> 4, chosen = choices.at[first + word];
        while (left > 16u * word) {
            left--;
            uint at = 2u * (field_begin + left), made;
            if (field_keeps(state, list.at[at], chosen >> 2u * (left & 15u) & 3u, made)) {
                kept++;
                if (write) {
                    to.at[2u * (end - kept)] = made;
                    to.at[2u * (end - kept) + 1u] = list.at[at + 1u];
                }
            }
        }
    }
    return kept;
}
