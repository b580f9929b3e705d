/* GLSL that walks over a list of instructions, with code for the kinds of one set only. CPU drivers run every arm of
 * every condition under a mask, so an instruction costs the sum of all kinds there: few kinds, and many samples that
 * share one walk. */
#include <stdio.h>
#include <string.h>

#include "eval/instructions.h"

typedef struct walk {
    const hewn_instruction_set *set;
    const hewn_walking *how;
    const char *type; /* of values */
    const char *bools;
    int flavour;     /* 0 point, 1 interval, 2 gradient */
    unsigned values; /* at once: 1, 4 points, or 32 in four rows of eight */
    bool chooses;
    bool repeated; /* walked again and again: what subgroups read together they keep */
    hewn_text *text;
} walk;

/* Instructions that are kept. */
enum { KEPT = 64 };

static const walk point_walk = {.type = "float", .bools = "bool", .flavour = 0, .values = 1};
static const walk four_walk = {.type = "float", .bools = "bool", .flavour = 0, .values = 4, .repeated = true};
static const walk word_walk = {.type = "float", .bools = "bool", .flavour = 0, .values = 32};
static const walk interval_walk = {.type = "vec2", .bools = "bvec2", .flavour = 1, .values = 1};
static const walk choice_walk = {.type = "vec2", .bools = "bvec2", .flavour = 1, .values = 1, .chooses = true};
static const walk gradient_walk = {.type = "vec4", .bools = "bvec4", .flavour = 2, .values = 1};
static const walk gradients_walk = {.type = "vec4", .bools = "bvec4", .flavour = 2, .values = 4, .repeated = true};

/* --- fetching ---------------------------------------------------------------------------------------------------- */

static const char *zero(const walk *own)
{
    return own->flavour == 0 ? "0.0" : own->flavour == 1 ? "vec2(0.0)" : "vec4(0.0)";
}

static void write_word(const walk *own, uint32_t i)
{
    uint32_t n = own->how->together;
    if (n)
        hewn_text_print(own->text, "subgroupShuffle(w%u,%uu)", i / n, i % n);
    else
        hewn_text_print(own->text, "code.at[at+%uu]", i);
}

static void write_number(const walk *own, const char *name, uint32_t i)
{
    hewn_text_print(own->text, "float %s=uintBitsToFloat(", name);
    write_word(own, i);
    hewn_text_append(own->text, ");\n");
}

static void write_fetch(const walk *own)
{
    uint32_t at = 1, n = own->how->together;
    for (uint32_t i = 0; n && i * n < own->set->words; i++)
        if (own->repeated)
            hewn_text_print(own->text, "uint w%u=field_kept[(at-chunk)/%uu+%uu];\n", i, n, i);
        else
            hewn_text_print(own->text, "uint w%u=code.at[at+%uu+gl_SubgroupInvocationID];\n", i, i * n);
    hewn_text_append(own->text, "uint head=");
    write_word(own, 0);
    hewn_text_append(own->text, ",body=head&255u,how=head>>8&15u,to=head>>12&15u;\n");
    if (own->set->blends) {
        write_number(own, "blend_size", 1);
        write_number(own, "inverse", 2);
        at = 3;
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

/* How much all bodies that are made of statements begin with, in bytes: it is computed once for all. The copy apart,
 * whose only statement is its return. */
static size_t common_start(const walk *own)
{
    const char *first = own->set->body_count > 1 ? own->set->bodies[1].texts[own->flavour].bytes : "";
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

/* The statements of a body after those in common, and its result into `r`. */
static void write_body(const walk *own, uint32_t i, size_t common)
{
    const char *text = own->set->bodies[i].texts[own->flavour].bytes + (i ? common : 0);
    const char *result = strstr(text, "return ");
    if (!own->how->masked)
        hewn_text_print(own->text, "if(body==%uu)", i);
    hewn_text_append(own->text, "{\n");
    hewn_text_append_bytes(own->text, text, (size_t)(result - text));
    result += strlen("return ");
    int length = (int)strcspn(result, ";");
    if (own->how->masked)
        hewn_text_print(own->text, "r=mix(r,%.*s,%s(body==%uu));\n}\n", length, result, own->bools, i);
    else
        hewn_text_print(own->text, "r=%.*s;\n}\n", length, result);
}

static void write_coordinates(const walk *own)
{
    if (own->values == 32)
        hewn_text_append(own->text, "float x=xs[k&7],y=ys[k>>3];\n");
    else if (own->values == 4 && own->flavour == 0)
        hewn_text_append(own->text, "float x=xs[k],y=ys[k],z=zs[k];\n");
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
    hewn_text_print(own->text, "%s r=%s;\n", own->type, zero(own));
    size_t common = common_start(own);
    if (common)
        hewn_text_append_bytes(own->text, set->bodies[1].texts[own->flavour].bytes, common);
    for (uint32_t i = first; i < set->body_count; i++)
        write_body(own, i, common);
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
    hewn_text_append(own->text, "choice=!near?0u:only_a?1u:only_r?2u:0u;\n}\n");
}

static void write_combinations(const walk *own)
{
    if (own->set->combination_count == 0)
        return;
    write_read(own, 'a', 16);
    for (uint32_t i = 0; own->chooses && i < own->set->combination_count; i++)
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

/* Reading memory is slow on CPU drivers, lane by lane; an array of one's own is not. Here one invocation's variable
 * holds one word of some, and the next one's the next. */
static void write_keeping(const walk *own)
{
    uint32_t n = own->how->together, words = own->set->words;
    hewn_text_print(own->text,
                    "for(uint chunk=field_begin;chunk<field_end;chunk+=%uu){\n"
                    "uint stop=min(field_end,chunk+%uu),wanted=field_kept_from==chunk?0u:(stop-chunk)/%uu;\n"
                    "for(uint i=0u;i<wanted;i++)\n"
                    "field_kept[i]=code.at[chunk+i*%uu+gl_SubgroupInvocationID];\n"
                    "field_kept_from=chunk;\n",
                    KEPT * words, KEPT * words, n, n);
}

static void write_walk(const walk *own)
{
    const hewn_instruction_set *set = own->set;
    char each[64] = "", array[16] = "";
    if (own->values > 1) {
        snprintf(each, sizeof each, "[[unroll]] for (int k = 0; k < %u; k++) ", own->values);
        snprintf(array, sizeof array, "[%u]", own->values);
    }
    for (uint32_t i = 0; i < set->slots; i++)
        hewn_text_print(own->text, "%s s%u%s;\n%ss%u%s=%s;\n", own->type, i, array, each, i, place(own), zero(own));
    bool keeps = own->repeated && own->how->together;
    hewn_text_append(own->text, "hewn_words code=hewn_words(field_code);\n");
    if (keeps)
        write_keeping(own);
    hewn_text_print(own->text, "for(uint at=%s;at<%s;at+=%uu){\n", keeps ? "chunk" : "field_begin",
                    keeps ? "stop" : "field_end", set->words);
    write_fetch(own);
    if (own->chooses)
        hewn_text_append(own->text, "uint choice=0u;\n");
    hewn_text_print(own->text, "%s{\n", each);
    write_arms(own);
    write_combinations(own);
    for (uint32_t i = 0; i < set->slots; i++)
        if (set->slots == 1)
            hewn_text_print(own->text, "s0%s=r;\n", place(own));
        else
            hewn_text_print(own->text, "s%u%s=mix(s%u%s,r,%s(to==%uu));\n", i, place(own), i, place(own), own->bools,
                            i);
    hewn_text_append(own->text, "}\n");
    if (own->chooses)
        hewn_text_append(own->text, "chosen|=choice<<2u*(made&15u);\nmade++;\n"
                                    "if((made&15u)==0u){\nchoices.at[first+(made>>4)-1u]=chosen;\nchosen=0u;\n}\n");
    hewn_text_append(own->text, keeps ? "}\n}\n" : "}\n");
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
        hewn_text_append(text, "vec2 field_choose(vec2 x,vec2 y,vec2 z,hewn_words choices,uint first)\n{\n"
                               "uint made=0u,chosen=0u;\nbool near=f_result(vec2(0.0),x,y,z).x==0.0;\n");
        hewn_text_append(text, how->whole ? "near=false;\n" : "");
        write_walk(&choices);
        hewn_text_append(text, "if((made&15u)!=0u)\nchoices.at[first+(made>>4)]=chosen;\n"
                               "return f_result(s0,x,y,z);\n}\n");
    }
}

void hewn_instruction_set_declare(const hewn_instruction_set *set, const hewn_walking *how, hewn_text *text)
{
    if (how->together)
        hewn_text_print(text, "#define FIELD_TOGETHER\nuint field_kept[%u];\n", KEPT * set->words / how->together);
    hewn_text_print(text,
                    "layout(buffer_reference, std430, buffer_reference_align = 4) buffer hewn_words { uint at[]; };\n"
                    "layout(set = 0, binding = 0) uniform hewn_list_block { uvec2 hewn_whole, hewn_lists, hewn_ranges; "
                    "uint hewn_whole_count; };\n"
                    "#define FIELD_WORDS %uu\n"
                    "uvec2 field_code = hewn_whole;\n"
                    "uint field_kept_from = 0xFFFFFFFFu;\n"
                    "uint field_begin = 0u, field_end = hewn_whole_count * FIELD_WORDS;\n"
                    "const uint FIELD_WHOLE = 0xFFFFFFFFu;\n"
                    "void field_select(uint slot)\n{\n"
                    "field_kept_from = 0xFFFFFFFFu;\n"
                    "field_code = hewn_whole;\n"
                    "field_begin = 0u;\n"
                    "field_end = hewn_whole_count * FIELD_WORDS;\n"
                    "if (slot != FIELD_WHOLE) {\n"
                    "hewn_words ranges = hewn_words(hewn_ranges);\n"
                    "field_code = hewn_lists;\n"
                    "field_begin = ranges.at[2u * slot] * FIELD_WORDS;\n"
                    "field_end = field_begin + ranges.at[2u * slot + 1u] * FIELD_WORDS;\n}\n}\n",
                    set->words);
}

void hewn_instruction_set_write(const hewn_instruction_set *set, const hewn_walking *how, uint32_t flavours,
                                hewn_text *text)
{
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
