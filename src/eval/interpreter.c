/* GLSL that walks over a list of instructions, with code for the kinds of one set only. CPU drivers run every arm of
 * every condition under a mask, so an instruction costs the sum of all kinds there: few kinds, and many samples that
 * share one walk. */
#include "eval/instructions.h"

typedef struct walk {
    const hewn_instruction_set *set;
    const char *type; /* of values */
    const char *bools;
    int flavour; /* 0 point, 1 interval, 2 gradient */
    bool rows;   /* 32 values at once */
    bool chooses;
    hewn_text *text;
} walk;

static const walk point_walk = {.type = "float", .bools = "bool", .flavour = 0};
static const walk word_walk = {.type = "float", .bools = "bool", .flavour = 0, .rows = true};
static const walk interval_walk = {.type = "vec2", .bools = "bvec2", .flavour = 1};
static const walk choice_walk = {.type = "vec2", .bools = "bvec2", .flavour = 1, .chooses = true};
static const walk gradient_walk = {.type = "vec4", .bools = "bvec4", .flavour = 2};

/* --- bodies ------------------------------------------------------------------------------------------------------ */

static void write_bodies(const walk *own)
{
    for (uint32_t i = 0; i < own->set->body_count; i++) {
        const hewn_body *body = &own->set->bodies[i];
        const char *t = own->type;
        hewn_text_print(own->text, "%s body_%u(%s x,%s y,%s z,%s b,%s c,%s d", t, i, t, t, t, t, t, t);
        for (uint32_t k = 0; k < body->numbers; k++)
            hewn_text_print(own->text, ",const float q%u", k);
        hewn_text_print(own->text, ")\n{\n%s}\n", body->texts[own->flavour].bytes);
    }
}

/* --- the walk ---------------------------------------------------------------------------------------------------- */

static const char *each(const walk *own)
{
    return own->rows ? "[[unroll]] for (int k = 0; k < 32; k++) " : "";
}

static const char *place(const walk *own)
{
    return own->rows ? "[k]" : "";
}

static const char *array(const walk *own)
{
    return own->rows ? "[32]" : "";
}

static const char *zero(const walk *own)
{
    return own->flavour == 0 ? "0.0" : own->flavour == 1 ? "vec2(0.0)" : "vec4(0.0)";
}

static void write_fetch(const walk *own)
{
    uint32_t at = 1;
    hewn_text_append(own->text, "uint head=code.at[at],body=head&255u,how=head>>8&15u,to=head>>12&15u;\n");
    if (own->set->blends) {
        hewn_text_append(own->text, "float blend_size=uintBitsToFloat(code.at[at+1u]),"
                                    "inverse=uintBitsToFloat(code.at[at+2u]);\n");
        at = 3;
    }
    for (uint32_t i = 0; at + i < own->set->words; i++)
        hewn_text_print(own->text, "float q%u=uintBitsToFloat(code.at[at+%uu]);\n", i, at + i);
}

/* A value from the slot that four bits of the head name. */
static void write_read(const walk *own, char name, uint32_t shift)
{
    hewn_text_print(own->text, "%s %c%s;\n", own->type, name, array(own));
    if (own->set->slots > 1)
        hewn_text_print(own->text, "uint from_%c=head>>%u&15u;\n", name, shift);
    hewn_text_print(own->text, "%s%c%s=", each(own), name, place(own));
    for (uint32_t i = own->set->slots; i-- > 1;)
        hewn_text_append(own->text, "mix(");
    hewn_text_print(own->text, "s0%s", place(own));
    for (uint32_t i = 1; i < own->set->slots; i++)
        hewn_text_print(own->text, ",s%u%s,%s(from_%c==%uu))", i, place(own), own->bools, name, i);
    hewn_text_append(own->text, ";\n");
}

static void write_arms(const walk *own)
{
    const hewn_instruction_set *set = own->set;
    uint32_t inputs = 0, first = set->slots == 1 ? 1 : 0; /* with one slot nothing is ever copied */
    for (uint32_t i = first; i < set->body_count; i++)
        inputs = set->bodies[i].inputs > inputs ? set->bodies[i].inputs : inputs;
    for (uint32_t i = 0; i < inputs; i++)
        write_read(own, (char)('b' + (int)i), 20 + 4 * i);
    hewn_text_print(own->text, "%s r%s;\n%sr%s=%s;\n", own->type, array(own), each(own), place(own), zero(own));
    for (uint32_t i = first; i < set->body_count; i++) {
        hewn_text_print(own->text, "if(body==%uu) %sr%s=body_%u(%s,z", i, each(own), place(own), i,
                        own->rows ? "xs[k&7],y[k>>3]" : "x,y");
        for (uint32_t k = 0; k < HEWN_BODY_INPUTS; k++)
            if (k < set->bodies[i].inputs)
                hewn_text_print(own->text, ",%c%s", 'b' + (int)k, place(own));
            else
                hewn_text_print(own->text, ",%s", zero(own));
        for (uint32_t k = 0; k < set->bodies[i].numbers; k++)
            hewn_text_print(own->text, ",q%u", k);
        hewn_text_append(own->text, ");\n");
    }
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
    if (own->chooses)
        for (uint32_t i = 0; i < own->set->combination_count; i++)
            write_choice(own, i);
    for (uint32_t i = 0; i < own->set->combination_count; i++) {
        const hewn_combination *one = &own->set->combinations[i];
        bool guard = own->flavour == 1 && one->guarded;
        const char *k = place(own);
        hewn_text_print(own->text, "if(how==%uu) %sr%s=%sf_%s(%s%s,%s%s%s)", i + 1, each(own), k,
                        guard ? "f_guard(" : "", one->function, one->swapped ? "r" : "a", k, one->swapped ? "a" : "r",
                        k, is_blend(one->op) ? ",blend_size,inverse" : "");
        if (guard)
            hewn_text_print(own->text, ",%s)", one->swapped ? "r,a" : "a,r");
        hewn_text_append(own->text, ";\n");
    }
}

static void write_walk(const walk *own)
{
    const hewn_instruction_set *set = own->set;
    for (uint32_t i = 0; i < set->slots; i++)
        hewn_text_print(own->text, "%s s%u%s;\n%ss%u%s=%s;\n", own->type, i, array(own), each(own), i, place(own),
                        zero(own));
    hewn_text_print(own->text, "hewn_words code=hewn_words(field_code);\n"
                               "for(uint at=field_begin;at<field_end;at+=%uu){\n",
                    set->words);
    write_fetch(own);
    if (own->chooses)
        hewn_text_append(own->text, "uint choice=0u;\n");
    write_arms(own);
    write_combinations(own);
    for (uint32_t i = 0; i < set->slots; i++)
        if (set->slots == 1)
            hewn_text_print(own->text, "%ss0%s=r%s;\n", each(own), place(own), place(own));
        else
            hewn_text_print(own->text, "%ss%u%s=mix(s%u%s,r%s,%s(to==%uu));\n", each(own), i, place(own), i, place(own),
                            place(own), own->bools, i);
    if (own->chooses)
        hewn_text_append(own->text, "chosen|=choice<<2u*(made&15u);\nmade++;\n"
                                    "if((made&15u)==0u){\nchoices.at[first+(made>>4)-1u]=chosen;\nchosen=0u;\n}\n");
    hewn_text_append(own->text, "}\n");
}

/* --- functions --------------------------------------------------------------------------------------------------- */

static walk started(walk kind, const hewn_instruction_set *set, hewn_text *text)
{
    kind.set = set;
    kind.text = text;
    return kind;
}

static void write_points(const hewn_instruction_set *set, uint32_t flavours, hewn_text *text)
{
    walk points = started(point_walk, set, text), words = started(word_walk, set, text);
    write_bodies(&points);
    if (flavours & HEWN_FLAVOUR_POINT) {
        hewn_text_append(text, "float field_point(float x,float y,float z)\n{\n");
        write_walk(&points);
        hewn_text_append(text, "return s0;\n}\n");
    }
    if (flavours & (HEWN_FLAVOUR_WORD | HEWN_FLAVOUR_ROW)) {
        hewn_text_append(text, "uint field_word_inside(uint i,vec4 y,float z)\n{\nfloat xs[8];\n"
                               "[[unroll]] for (uint k = 0u; k < 8u; k++) xs[k]=sample_x(i+k);\n");
        write_walk(&words);
        hewn_text_append(text, "uint bits=0u;\n[[unroll]] for (int k = 0; k < 32; k++) "
                               "bits|=uint(s0[k]<0.0)<<k;\nreturn bits;\n}\n");
    }
    if (flavours & HEWN_FLAVOUR_ROW)
        hewn_text_append(text, "uint field_row_inside(uint i,float y,float z)\n{\n"
                               "return field_word_inside(i,vec4(y),z)&255u;\n}\n");
}

static void write_intervals(const hewn_instruction_set *set, uint32_t flavours, hewn_text *text)
{
    walk intervals = started(interval_walk, set, text), choices = started(choice_walk, set, text);
    write_bodies(&intervals);
    if (flavours & HEWN_FLAVOUR_INTERVAL) {
        hewn_text_append(text, "vec2 field_interval(vec2 x,vec2 y,vec2 z)\n{\n");
        write_walk(&intervals);
        hewn_text_append(text, "return f_result(s0,x,y,z);\n}\n");
    }
    if (flavours & HEWN_FLAVOUR_CHOICES) {
        hewn_text_append(text, "vec2 field_choose(vec2 x,vec2 y,vec2 z,hewn_words choices,uint first)\n{\n"
                               "uint made=0u,chosen=0u;\nbool near=f_result(vec2(0.0),x,y,z).x==0.0;\n");
        write_walk(&choices);
        hewn_text_append(text, "if((made&15u)!=0u)\nchoices.at[first+(made>>4)]=chosen;\n"
                               "return f_result(s0,x,y,z);\n}\n");
    }
}

void hewn_instruction_set_declare(const hewn_instruction_set *set, hewn_text *text)
{
    hewn_text_print(text,
                    "layout(buffer_reference, std430, buffer_reference_align = 4) buffer hewn_words { uint at[]; };\n"
                    "layout(set = 0, binding = 0) uniform hewn_list_block { uvec2 hewn_whole, hewn_lists, hewn_ranges; "
                    "uint hewn_whole_count; };\n"
                    "#define FIELD_WORDS %uu\n"
                    "uvec2 field_code = hewn_whole;\n"
                    "uint field_begin = 0u, field_end = hewn_whole_count * FIELD_WORDS;\n"
                    "void field_select(uint slot)\n{\n"
                    "hewn_words ranges = hewn_words(hewn_ranges);\n"
                    "field_code = hewn_lists;\n"
                    "field_begin = ranges.at[2u * slot] * FIELD_WORDS;\n"
                    "field_end = field_begin + ranges.at[2u * slot + 1u] * FIELD_WORDS;\n}\n",
                    set->words);
}

void hewn_instruction_set_write(const hewn_instruction_set *set, uint32_t flavours, hewn_text *text)
{
    if (flavours & (HEWN_FLAVOUR_POINT | HEWN_FLAVOUR_WORD | HEWN_FLAVOUR_ROW))
        write_points(set, flavours, text);
    if (flavours & (HEWN_FLAVOUR_INTERVAL | HEWN_FLAVOUR_CHOICES))
        write_intervals(set, flavours, text);
    if (flavours & HEWN_FLAVOUR_GRADIENT) {
        walk gradients = started(gradient_walk, set, text);
        write_bodies(&gradients);
        hewn_text_append(text, "vec4 field_gradient(float at_x,float at_y,float at_z)\n{\n"
                               "vec4 x=vec4(1.0,0.0,0.0,at_x),y=vec4(0.0,1.0,0.0,at_y),z=vec4(0.0,0.0,1.0,at_z);\n");
        write_walk(&gradients);
        hewn_text_append(text, "return s0;\n}\n");
    }
}
