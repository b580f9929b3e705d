/* GLSL that walks over a list of instructions, with code for the kinds of one set only. CPU drivers run every arm of
 * every condition under a mask, so an instruction costs the sum of all kinds there: few kinds, and many samples that
 * share one walk. */
#include <stdio.h>
#include <string.h>

#include "eval/bodies.h"

extern const char hewn_text_keep_list[];

typedef struct walk {
    const hewn_instruction_set *set;
    const hewn_walking *how;
    const char *type; /* of values */
    const char *bools;
    int flavour;     /* 0 point, 1 interval, 2 gradient */
    unsigned values; /* at once: 1, 4, or 32 points in four rows of eight */
    enum { COMPUTES, CHOOSES, NARROWS } purpose;
    bool repeated; /* walked again and again: what subgroups read together they keep */
    hewn_text *text;
} walk;

/* Instructions that are kept. */
enum { KEPT = 128 };

static const walk point_walk = {.type = "float", .bools = "bool", .flavour = 0, .values = 1};
static const walk four_walk = {.type = "float", .bools = "bool", .flavour = 0, .values = 4, .repeated = true};
static const walk word_walk = {.type = "float", .bools = "bool", .flavour = 0, .values = 32, .repeated = true};
static const walk interval_walk = {.type = "vec2", .bools = "bvec2", .flavour = 1, .values = 1, .repeated = true};
static const walk choice_walk = {.type = "vec2", .bools = "bvec2", .flavour = 1, .values = 4, .purpose = CHOOSES};
static const walk narrow_walk = {
    .type = "vec2", .bools = "bvec2", .flavour = 1, .values = 1, .purpose = NARROWS, .repeated = true};
static const walk gradient_walk = {.type = "vec4", .bools = "bvec4", .flavour = 2, .values = 1, .repeated = true};
static const walk gradients_walk = {.type = "vec4", .bools = "bvec4", .flavour = 2, .values = 4, .repeated = true};

/* --- fetching ---------------------------------------------------------------------------------------------------- */

static const char *zero(const walk *own)
{
    return own->flavour == 0 ? "0.0" : own->flavour == 1 ? "vec2(0.0)" : "vec4(0.0)";
}

static bool keeps(const walk *own)
{
    return own->repeated && own->how->together;
}

static void write_number(const walk *own, const char *name, uint32_t i)
{
    uint32_t n = own->how->together;
    if (n)
        hewn_text_print(own->text, "float %s=uintBitsToFloat(subgroupShuffle(w%u,%uu));\n", name, i / n, i % n);
    else
        hewn_text_print(own->text, "float %s=uintBitsToFloat(code.at[from+%uu]);\n", name, i);
}

/* The numbers of the instruction `from`. */
static void write_fetch(const walk *own)
{
    uint32_t at = 0, n = own->how->together;
    for (uint32_t i = 0; n && i * n < own->set->words; i++)
        if (keeps(own))
            hewn_text_print(own->text, "uint w%u=field_words[from+%uu];\n", i, i);
        else
            hewn_text_print(own->text, "uint w%u=code.at[from+%uu+gl_SubgroupInvocationID];\n", i, i * n);
    hewn_text_append(own->text, "uint body=head&255u,how=head>>8&15u,to=head>>12&15u;\n");
    if (own->set->blends) {
        write_number(own, "blend_size", 0);
        write_number(own, "inverse", 1);
        at = 2;
    }
    for (uint32_t i = 0; at + i < own->set->words; i++) {
        char name[8] = {'q', (char)('0' + i / 10), (char)('0' + i % 10)};
        write_number(own, i < 10 ? (char[3]){'q', (char)('0' + i)} : name, at + i);
    }
}

/* --- bodies ------------------------------------------------------------------------------------------------------ */

static const char *place(const walk *own)
{
    return own->values > 1 ? "[k]" : "";
}

/* A value from the slot that four bits of the head name. */
static void write_read(const walk *own, char name, uint32_t shift)
{
    hewn_text_print(own->text, "%s %c=", own->type, name);
    for (uint32_t i = own->set->slots; i-- > 1;)
        hewn_text_append(own->text, "mix(");
    hewn_text_print(own->text, "s0%s", place(own));
    for (uint32_t i = 1; i < own->set->slots; i++)
        hewn_text_print(own->text, ",s%u%s,%s((head>>%u&15u)==%uu))", i, place(own), own->bools, shift, i);
    hewn_text_append(own->text, ";\n");
}

/* With one slot nothing is ever copied. */
static uint32_t first_body(const walk *own)
{
    return own->set->slots == 1 && own->set->body_count > 1 ? 1 : 0;
}

/* Whether a body goes by an address among its numbers: those of other bodies must not be taken for one. */
static bool reads_samples(const char *body)
{
    return strstr(body, "f_sampled(") != NULL || strstr(body, "f_outline_table(") != NULL;
}

/* How much all bodies that are made of statements begin with, in bytes: it is computed once for all. The copy apart,
 * whose only statement is its return. */
static size_t common_start(const walk *own)
{
    const char *first = own->set->body_count > 1 ? own->set->bodies[1].texts[own->flavour].bytes : "";
    if (reads_samples(first))
        return 0;
    size_t common = strlen(first);
    for (uint32_t i = 1; i < own->set->body_count; i++) {
        const char *text = own->set->bodies[i].texts[own->flavour].bytes;
        size_t same = 0, lines = 0;
        for (; same < common && text[same] == first[same]; same++)
            lines = text[same] == '\n' ? same + 1 : lines;
        common = same < common || text[same] == 0 ? lines : common;
    }
    const char *end = strstr(first, "return ");
    return end && (size_t)(end - first) < common ? (size_t)(end - first) : common;
}

/* What a body returns; where that is a root, what it is taken of. */
static const char *find_result(const char *body, bool *rooted)
{
    const char *result = strstr(body, "return ") + strlen("return ");
    *rooted = strncmp(result, HEWN_BODY_ROOT, strlen(HEWN_BODY_ROOT)) == 0;
    return *rooted ? result + strlen(HEWN_BODY_ROOT) : result;
}

/* The statements of a body after those in common, and its result into `r` or `root`. */
static void write_body(const walk *own, uint32_t i, size_t common)
{
    const char *text = own->set->bodies[i].texts[own->flavour].bytes + (i ? common : 0);
    bool rooted, masked = own->how->masked && !reads_samples(text);
    const char *result = find_result(text, &rooted);
    int length = (int)strcspn(result, rooted ? ")" : ";");
    if (!masked)
        hewn_text_print(own->text, "if(body==%uu)", i);
    hewn_text_append(own->text, "{\n");
    hewn_text_append_bytes(own->text, text, (size_t)(strstr(text, "return ") - text));
    if (!masked)
        hewn_text_print(own->text, "%s=%.*s;\n}\n", rooted ? "root" : "r", length, result);
    else if (rooted)
        hewn_text_print(own->text,
                        "root.square=mix(root.square,%.*s.square,body==%uu);\n"
                        "root.rest=mix(root.rest,%.*s.rest,body==%uu);\n}\n",
                        length, result, i, length, result, i);
    else
        hewn_text_print(own->text, "r=mix(r,%.*s,%s(body==%uu));\n}\n", length, result, own->bools, i);
}

static bool is_rooted(const walk *own, uint32_t i)
{
    bool rooted;
    find_result(own->set->bodies[i].texts[own->flavour].bytes, &rooted);
    return rooted;
}

static uint32_t count_rooted(const walk *own, uint32_t first)
{
    uint32_t rooted = 0;
    for (uint32_t i = first; i < own->set->body_count; i++)
        rooted += is_rooted(own, i);
    return rooted;
}

/* Bodies that end with a root share one: where all arms run, each would take its own. */
static void write_root(const walk *own, uint32_t first, bool always)
{
    hewn_text_append(own->text, always ? "r=f_rooted(root);\n" : "r=mix(r,f_rooted(root),false");
    for (uint32_t i = first; !always && i < own->set->body_count; i++)
        if (is_rooted(own, i))
            hewn_text_print(own->text, "||body==%uu", i);
    hewn_text_append(own->text, always ? "" : ");\n");
}

static void write_coordinates(const walk *own)
{
    if (own->values == 32)
        hewn_text_append(own->text, "float x=xs[k&7],y=ys[k>>3];\n");
    else if (own->values == 4 && own->flavour < 2)
        hewn_text_print(own->text, "%s x=xs[k],y=ys[k],z=zs[k];\n", own->type);
    else if (own->values == 4)
        hewn_text_append(own->text, "vec4 x=vec4(1.0,0.0,0.0,xs[k]),y=vec4(0.0,1.0,0.0,ys[k]),"
                                    "z=vec4(0.0,0.0,1.0,zs[k]);\n");
}

static void write_arms(const walk *own)
{
    const hewn_instruction_set *set = own->set;
    uint32_t inputs = 0, first = first_body(own);
    for (uint32_t i = first; i < set->body_count; i++)
        inputs = set->bodies[i].inputs > inputs ? set->bodies[i].inputs : inputs;
    write_coordinates(own);
    for (uint32_t i = 0; i < inputs; i++)
        write_read(own, (char)('b' + (int)i), 20 + 4 * i);
    uint32_t rooted = count_rooted(own, first);
    hewn_text_print(own->text, "%s r=%s;\n%s", own->type, zero(own),
                    rooted ? "f_radicand root=f_radicand(0.0,0.0);\n" : "");
    size_t common = common_start(own);
    if (common)
        hewn_text_append_bytes(own->text, set->bodies[1].texts[own->flavour].bytes, common);
    for (uint32_t i = first; i < set->body_count; i++)
        write_body(own, i, common);
    if (rooted)
        write_root(own, first, rooted == set->body_count - first);
}

static bool is_blend(hewn_op op)
{
    return op >= HEWN_OP_BLEND_QUADRATIC && op <= HEWN_OP_BLEND_EXPONENTIAL;
}

/* Which operand is certain not to matter in the box: then the arithmetic returns the other one's bits. A difference of
 * bounds is rounded as differences of values are, which is monotone, so what it says of them holds of what is computed.
 */
static void write_choice(const walk *own, uint32_t which)
{
    const hewn_combination *one = &own->set->combinations[which];
    hewn_text_print(own->text, "if(how==%uu){\n", which + 1);
    if (one->op == HEWN_OP_MIN)
        hewn_text_append(own->text, "bool only_a=a.y<r.x,only_r=r.y<a.x;\n");
    else if (one->op == HEWN_OP_MAX)
        hewn_text_append(own->text, "bool only_a=a.x>r.y,only_r=r.x>a.y;\n");
    else
        hewn_text_print(own->text,
                        "precise float above=r.x-a.y,below=a.x-r.y;\n"
                        "bool ends=abs(inverse)<=3.0e38,only_a=%s&&ends,only_r=%s&&ends;\n",
                        one->op == HEWN_OP_BLEND_EXPONENTIAL ? "(above*blend_size>105.0)" : "(above>=blend_size)",
                        one->op == HEWN_OP_BLEND_EXPONENTIAL ? "(below*blend_size>105.0)" : "(below>=blend_size)");
    hewn_text_print(own->text, "without_r=near%s&&only_a;\nwithout_a=near%s&&only_r;\n}\n", place(own), place(own));
}

static void write_combinations(const walk *own)
{
    if (own->set->combination_count == 0)
        return;
    write_read(own, 'a', 16);
    for (uint32_t i = 0; own->purpose != COMPUTES && i < own->set->combination_count; i++)
        write_choice(own, i);
    for (uint32_t i = 0; i < own->set->combination_count; i++) {
        const hewn_combination *one = &own->set->combinations[i];
        bool guard = own->flavour == 1 && one->guarded;
        const char *order = one->swapped ? "r,a" : "a,r";
        if (own->how->masked)
            hewn_text_print(own->text, "%s r%u=", own->type, i + 1);
        else
            hewn_text_print(own->text, "if(how==%uu) r=", i + 1);
        hewn_text_print(own->text, "%sf_%s(%s%s)", guard ? "f_guard(" : "", one->function, order,
                        is_blend(one->op) ? ",blend_size,inverse" : "");
        if (guard)
            hewn_text_print(own->text, ",%s)", order);
        hewn_text_append(own->text, ";\n");
    }
    for (uint32_t i = 0; own->how->masked && i < own->set->combination_count; i++)
        hewn_text_print(own->text, "r=mix(r,r%u,%s(how==%uu));\n", i + 1, own->bools, i + 1);
}

/* What is noted of an instruction: in words for memory, or for the vote of a subgroup. */
static void write_note(const walk *own)
{
    if (own->purpose == CHOOSES)
        hewn_text_print(own->text, "chosen%s|=(without_r?1u:without_a?2u:0u)<<2u*(made&15u);\n", place(own));
    else if (own->purpose == NARROWS)
        hewn_text_append(own->text, "only_a|=uint(without_r)<<(at&31u);\nonly_r|=uint(without_a)<<(at&31u);\n");
}

/* One instruction: its head is `head`, its numbers begin at `from`. */
static void write_instruction(const walk *own, const char *each)
{
    const hewn_instruction_set *set = own->set;
    write_fetch(own);
    hewn_text_print(own->text, "%s{\n", each);
    if (own->purpose != COMPUTES)
        hewn_text_append(own->text, "bool without_r=false,without_a=false;\n");
    write_arms(own);
    write_combinations(own);
    for (uint32_t i = 0; i < set->slots; i++)
        if (set->slots == 1)
            hewn_text_print(own->text, "s0%s=r;\n", place(own));
        else
            hewn_text_print(own->text, "s%u%s=mix(s%u%s,r,%s(to==%uu));\n", i, place(own), i, place(own), own->bools,
                            i);
    write_note(own);
    hewn_text_append(own->text, "}\n");
    if (own->purpose == CHOOSES) {
        hewn_text_append(own->text, "made++;\nif((made&15u)==0u){\n");
        hewn_text_print(own->text, "%s{\nchoices.at[first%s+(made>>4)-1u]=chosen%s;\nchosen%s=0u;\n}\n}\n", each,
                        place(own), place(own), place(own));
    }
}

/* Votes are taken by exchange with neighbours ever farther off. An invocation that nothing matters to agrees to all. */
static void write_vote(const walk *own)
{
    hewn_text_append(own->text, "if(!matters)\nonly_a=only_r=~0u;\n");
    for (uint32_t far = 1; far < own->how->together; far *= 2)
        hewn_text_print(own->text,
                        "only_a&=subgroupShuffle(only_a,gl_SubgroupInvocationID^%uu);\n"
                        "only_r&=subgroupShuffle(only_r,gl_SubgroupInvocationID^%uu);\n",
                        far, far);
    hewn_text_append(own->text, "field_without_r[(at-1u)>>5]=only_a;\nfield_without_a[(at-1u)>>5]=only_r;\n");
}

/* A loop that subgroups leave together tests at its end: where llvmpipe leaves one at its beginning, it runs through
 * all that follows once more under an empty mask. Where invocations leave one by one it must test at its beginning,
 * though: what was computed before a test is not kept from the rounds that others still take. No list is empty. */
static void write_loop(const walk *own, const char *each)
{
    hewn_text *text = own->text;
    uint32_t words = own->set->words, n = own->how->together;
    if (own->purpose == NARROWS) {
        hewn_text_print(text,
                        "uint at=0u;\ndo{\nuint only_a=0u,only_r=0u,stop=min(count,at+32u);\n"
                        "do{\nuint head=field_all[at],from=at*%uu;\n",
                        words / n);
        write_instruction(own, each);
        hewn_text_append(text, "at++;\n}while(at<stop);\n");
        write_vote(own);
        hewn_text_append(text, "}while(at<count);\n");
    } else if (keeps(own)) {
        hewn_text_print(
            text,
            "uint chunk=field_begin;\ndo{\nif(field_kept_from!=chunk)field_load(chunk);\nuint "
            "at=field_first;\n"
            "do{\nuint "
            "head=field_narrowed?field_heads[at]:field_all[at],from=(field_narrowed?field_order[at]:at)*%uu;\n",
            words / n);
        write_instruction(own, each);
        hewn_text_print(text, "at++;\n}while(at<field_last);\nchunk+=%uu;\n}while(chunk<field_end);\n", KEPT);
    } else if (n) {
        hewn_text_print(text,
                        "hewn_words list=hewn_words(field_list),code=hewn_words(hewn_numbers_at);\nuint "
                        "at=field_begin;\n"
                        "do{\nuint entries=list.at[2u*at+gl_SubgroupInvocationID],entry=0u,entry_end=min(%uu,field_end-"
                        "at);\n"
                        "do{\nuint head=subgroupShuffle(entries,2u*entry),from=subgroupShuffle(entries,2u*entry+1u)*"
                        "FIELD_WORDS;\n",
                        n / 2);
        write_instruction(own, each);
        hewn_text_append(text, "entry++;\n}while(entry<entry_end);\nat+=entry_end;\n}while(at<field_end);\n");
    } else {
        hewn_text_append(text,
                         "hewn_words list=hewn_words(field_list),code=hewn_words(hewn_numbers_at);\nuint "
                         "at=field_begin;\n"
                         "for(;at<field_end;at++){\nuint head=list.at[2u*at],from=list.at[2u*at+1u]*FIELD_WORDS;\n");
        write_instruction(own, each);
        hewn_text_append(text, "}\n");
    }
}

static void write_walk(const walk *own)
{
    char each[64] = "", array[16] = "";
    if (own->values > 1) {
        snprintf(each, sizeof each, "[[unroll]] for (int k = 0; k < %u; k++) ", own->values);
        snprintf(array, sizeof array, "[%u]", own->values);
    }
    for (uint32_t i = 0; i < own->set->slots; i++)
        hewn_text_print(own->text, "%s s%u%s;\n%ss%u%s=%s;\n", own->type, i, array, each, i, place(own), zero(own));
    write_loop(own, each);
}

/* --- functions --------------------------------------------------------------------------------------------------- */

static walk started(walk kind, const hewn_instruction_set *set, const hewn_walking *how, hewn_text *text)
{
    kind.set = set;
    kind.how = how;
    kind.text = text;
    return kind;
}

static void write_points(const hewn_instruction_set *set, const hewn_walking *how, uint32_t flavours, hewn_text *text)
{
    walk points = started(point_walk, set, how, text), words = started(word_walk, set, how, text);
    if (flavours & HEWN_FLAVOUR_POINT) {
        hewn_text_append(text, "float field_point(float x,float y,float z)\n{\n");
        write_walk(&points);
        hewn_text_append(text, "return s0;\n}\n");
    }
    if (flavours & (HEWN_FLAVOUR_WORD | HEWN_FLAVOUR_ROW)) {
        hewn_text_append(text, "uint field_word_inside(uint i,vec4 ys,float z)\n{\nfloat xs[8];\n"
                               "[[unroll]] for (uint k = 0u; k < 8u; k++) xs[k]=sample_x(i+k);\n");
        write_walk(&words);
        hewn_text_append(text, "uint bits=0u;\n[[unroll]] for (int k = 0; k < 32; k++) "
                               "bits|=uint(s0[k]<0.0)<<k;\nreturn bits;\n}\n");
    }
    if (flavours & HEWN_FLAVOUR_ROW)
        hewn_text_append(text, "uint field_row_inside(uint i,float y,float z)\n{\n"
                               "return field_word_inside(i,vec4(y),z)&255u;\n}\n");
}

/* Reading memory is slow on CPU drivers, lane by lane; an array of one's own is not. Of the numbers one invocation's
 * variable holds one word of some, and the next one's the next; heads and order are the same for all. */
static void write_keeping(const hewn_instruction_set *set, const hewn_walking *how, hewn_text *text)
{
    uint32_t n = how->together, parts = set->words / n;
    hewn_text_print(text,
                    "uint field_words[%u],field_all[%u],field_heads[%u],field_order[%u],field_first=0u,field_last=0u;\n"
                    "uint field_without_a[%u],field_without_r[%u];\nbool field_narrowed=false;\n"
                    "void field_load(uint chunk)\n{\n"
                    "hewn_words list=hewn_words(field_list),code=hewn_words(hewn_numbers_at);\n"
                    "uint at=chunk,stop=min(field_end,chunk+%uu);\n"
                    "do{\nuint entries=list.at[2u*at+gl_SubgroupInvocationID],entry=0u,entry_end=min(%uu,stop-at);\n"
                    "do{\nuint i=at-chunk+entry,head=subgroupShuffle(entries,2u*entry),"
                    "from=subgroupShuffle(entries,2u*entry+1u)*FIELD_WORDS;\n"
                    "field_all[i]=head;\n",
                    KEPT * parts, KEPT, KEPT, KEPT, KEPT / 32, KEPT / 32, KEPT, n / 2);
    for (uint32_t i = 0; i < parts; i++)
        hewn_text_print(text, "field_words[i*%uu+%uu]=code.at[from+%uu+gl_SubgroupInvocationID];\n", parts, i, i * n);
    hewn_text_append(text,
                     "entry++;\n}while(entry<entry_end);\nat+=entry_end;\n}while(at<stop);\n"
                     "field_kept_from=chunk;\nfield_first=0u;\nfield_last=stop-chunk;\nfield_narrowed=false;\n}\n");
}

static void write_narrowing(const hewn_instruction_set *set, const hewn_walking *how, hewn_text *text)
{
    walk narrow = started(narrow_walk, set, how, text);
    hewn_text_append(text, "void field_narrow(vec2 x,vec2 y,vec2 z,bool matters,uint least)\n{\n");
    if (!how->together || how->whole || set->combination_count == 0) {
        hewn_text_append(text, "}\n");
        return;
    }
    hewn_text_print(text,
                    "uint count=field_end-field_begin;\nif(count>=least&&count<=%uu){\n"
                    "if(field_kept_from!=field_begin)field_load(field_begin);\n"
                    "bool near=f_result(vec2(0.0),x,y,z).x==0.0;\n",
                    KEPT);
    write_walk(&narrow);
    hewn_text_append(text, "Keeping state=field_keeping();\nuint left=count;\nfield_first=field_last=count;\n"
                           "field_narrowed=true;\ndo{\nleft--;\n"
                           "bool no_r=(field_without_r[left>>5]>>(left&31u)&1u)!=0u,"
                           "no_a=(field_without_a[left>>5]>>(left&31u)&1u)!=0u;\nuint made;\n"
                           "if(field_keeps(state,field_all[left],no_r?1u:no_a?2u:0u,made)){\nfield_first--;\n"
                           "field_heads[field_first]=made;\nfield_order[field_first]=left;\n}\n"
                           "}while(left>0u&&state.used!=0u);\n}\n}\n");
}

static void write_fours(const hewn_instruction_set *set, const hewn_walking *how, hewn_text *text)
{
    walk points = started(four_walk, set, how, text), gradients = started(gradients_walk, set, how, text);
    hewn_text_append(text, "vec4 field_points(vec4 xs,vec4 ys,vec4 zs)\n{\n");
    write_walk(&points);
    hewn_text_append(text, "return vec4(s0[0],s0[1],s0[2],s0[3]);\n}\n"
                           "void field_gradients(vec4 xs,vec4 ys,vec4 zs,out vec4 gradients[4])\n{\n");
    write_walk(&gradients);
    hewn_text_append(text, "[[unroll]] for (int k = 0; k < 4; k++) gradients[k]=s0[k];\n}\n");
}

static void write_intervals(const hewn_instruction_set *set, const hewn_walking *how, uint32_t flavours,
                            hewn_text *text)
{
    walk intervals = started(interval_walk, set, how, text), choices = started(choice_walk, set, how, text);
    if (flavours & HEWN_FLAVOUR_INTERVAL) {
        hewn_text_append(text, "vec2 field_interval(vec2 x,vec2 y,vec2 z)\n{\n");
        write_walk(&intervals);
        hewn_text_append(text, "return f_result(s0,x,y,z);\n}\n");
    }
    if (flavours & HEWN_FLAVOUR_CHOICES) {
        hewn_text_print(text,
                        "void field_choose(vec2 xs[4],vec2 ys[4],vec2 zs[4],hewn_words choices,uint first[4],"
                        "out vec2 ranges[4])\n{\nuint made=0u,chosen[4];\nbool near[4];\n"
                        "[[unroll]] for (int k = 0; k < 4; k++) {\nchosen[k]=0u;\n"
                        "near[k]=%sf_result(vec2(0.0),xs[k],ys[k],zs[k]).x==0.0;\n}\n",
                        how->whole ? "false&&" : "");
        write_walk(&choices);
        hewn_text_append(text, "[[unroll]] for (int k = 0; k < 4; k++) {\nif((made&15u)!=0u)\n"
                               "choices.at[first[k]+(made>>4)]=chosen[k];\n"
                               "ranges[k]=f_result(s0[k],xs[k],ys[k],zs[k]);\n}\n}\n");
        hewn_text_append(text, hewn_text_keep_list);
    }
}

void hewn_instruction_set_declare(const hewn_instruction_set *set, const hewn_walking *how, hewn_text *text)
{
    if (how->together)
        hewn_text_append(text, "#define FIELD_TOGETHER\n");
    hewn_text_print(
        text,
        "#define FIELD_LISTED\n"
        "layout(buffer_reference, std430, buffer_reference_align = 4) buffer hewn_words { uint at[]; };\n"
        "layout(set = 0, binding = 0) uniform hewn_list_block { uvec2 hewn_numbers_at, hewn_whole, hewn_lists, "
        "hewn_ranges, hewn_around, hewn_around_ranges, hewn_origins; uint hewn_whole_count; };\n"
        "#define FIELD_WORDS %uu\n"
        "uvec2 field_list = hewn_whole;\n"
        "uint field_kept_from = 0xFFFFFFFFu;\n"
        "uint field_begin = 0u, field_end = hewn_whole_count;\n"
        "const uint FIELD_WHOLE = 0xFFFFFFFFu, FIELD_AROUND = 0x80000000u;\n"
        "uint field_around(uint slot)\n{\n"
        "uint list = FIELD_AROUND | hewn_words(hewn_origins).at[slot] >> 6;\n"
        "return hewn_around == uvec2(0u) ? FIELD_WHOLE : list;\n}\n"
        "void field_select(uint list)\n{\n"
        "field_kept_from = 0xFFFFFFFFu;\n"
        "field_list = hewn_whole;\n"
        "field_begin = 0u;\n"
        "field_end = hewn_whole_count;\n"
        "if (list != FIELD_WHOLE) {\n"
        "bool around = list >= FIELD_AROUND;\n"
        "hewn_words ranges = hewn_words(around ? hewn_around_ranges : hewn_ranges);\n"
        "uint at = 2u * (list & ~FIELD_AROUND);\n"
        "field_list = around ? hewn_around : hewn_lists;\n"
        "field_begin = ranges.at[at];\n"
        "field_end = field_begin + ranges.at[at + 1u];\n}\n}\n",
        set->words);
}

void hewn_instruction_set_write(const hewn_instruction_set *set, const hewn_walking *how, uint32_t flavours,
                                hewn_text *text)
{
    const uint32_t many = HEWN_FLAVOUR_FOUR | HEWN_FLAVOUR_WORD | HEWN_FLAVOUR_ROW;
    if (how->together && flavours & (many | HEWN_FLAVOUR_INTERVAL | HEWN_FLAVOUR_GRADIENT))
        write_keeping(set, how, text);
    if (flavours & many)
        write_narrowing(set, how, text);
    if (flavours & (HEWN_FLAVOUR_POINT | HEWN_FLAVOUR_WORD | HEWN_FLAVOUR_ROW))
        write_points(set, how, flavours, text);
    if (flavours & (HEWN_FLAVOUR_INTERVAL | HEWN_FLAVOUR_CHOICES))
        write_intervals(set, how, flavours, text);
    if (flavours & HEWN_FLAVOUR_FOUR)
        write_fours(set, how, text);
    if (flavours & HEWN_FLAVOUR_GRADIENT) {
        walk gradients = started(gradient_walk, set, how, text);
        hewn_text_append(text, "vec4 field_gradient(float at_x,float at_y,float at_z)\n{\n"
                               "vec4 x=vec4(1.0,0.0,0.0,at_x),y=vec4(0.0,1.0,0.0,at_y),z=vec4(0.0,0.0,1.0,at_z);\n");
        write_walk(&gradients);
        hewn_text_append(text, "return s0;\n}\n");
    }
}
