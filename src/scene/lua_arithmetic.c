/* Arithmetic on numbers and fields, as operators, functions and methods. A function of plain numbers gives a number, by
 * the same rules as the field's own operation. */
#include <math.h>

#include "scene/lua_state.h"

static hewn_field *field_of(lua_State *L)
{
    return hewn_lua_of(L)->scene->field;
}

/* --- on numbers ----------------------------------------------------------------------------------------------------
 */

static double number_neg(double a)
{
    return -a;
}

static double number_square(double a)
{
    return a * a;
}

static double number_not(double a)
{
    return a == 0 ? 1 : 0;
}

static double number_min(double a, double b)
{
    return isnan(a) || isnan(b) ? NAN : b < a ? b : a;
}

static double number_max(double a, double b)
{
    return isnan(a) || isnan(b) ? NAN : b > a ? b : a;
}

static double number_mod(double a, double b)
{
    double rest = fmod(a, b);
    return rest < 0 ? rest + fabs(b) : rest;
}

static double number_compare(double a, double b)
{
    return isnan(a) || isnan(b) ? NAN : (double)((a > b) - (a < b));
}

static double number_and(double a, double b)
{
    return a == 0 ? a : b;
}

static double number_or(double a, double b)
{
    return a != 0 ? a : b;
}

/* --- functions -----------------------------------------------------------------------------------------------------
 */

typedef struct unary {
    const char *name;
    double (*number)(double);
    hewn_node (*node)(hewn_field *, hewn_node);
} unary;

static const unary unaries[] = {
    {"neg", number_neg, hewn_neg}, {"abs", fabs, hewn_abs},
    {"sqrt", sqrt, hewn_sqrt},     {"square", number_square, hewn_square},
    {"sin", sin, hewn_sin},        {"cos", cos, hewn_cos},
    {"tan", tan, hewn_tan},        {"asin", asin, hewn_asin},
    {"acos", acos, hewn_acos},     {"atan", atan, hewn_atan},
    {"exp", exp, hewn_exp},        {"ln", log, hewn_ln},
    {"floor", floor, hewn_floor},  {"ceil", ceil, hewn_ceil},
    {"round", round, hewn_round},  {"logic_not", number_not, hewn_logic_not},
};

typedef struct binary {
    const char *name;
    double (*number)(double, double);
    hewn_node (*node)(hewn_field *, hewn_node, hewn_node);
} binary;

static const binary binaries[] = {
    {"atan2", atan2, hewn_atan2},
    {"mod", number_mod, hewn_mod},
    {"compare", number_compare, hewn_compare},
    {"logic_and", number_and, hewn_logic_and},
    {"logic_or", number_or, hewn_logic_or},
};

static const binary folds[] = {
    {"min", number_min, hewn_min},
    {"max", number_max, hewn_max},
};

static int call_unary(lua_State *L)
{
    const unary *op = &unaries[lua_tointeger(L, lua_upvalueindex(1))];
    hewn_lua_check_count(L, op->name, 1, 1);
    if (lua_type(L, 1) == LUA_TNUMBER) {
        lua_pushnumber(L, op->number(lua_tonumber(L, 1)));
        return 1;
    }
    return hewn_lua_push_field(L, op->node(field_of(L), hewn_lua_operand(L, 1, op->name)));
}

static int call_binary(lua_State *L)
{
    const binary *op = &binaries[lua_tointeger(L, lua_upvalueindex(1))];
    hewn_lua_check_count(L, op->name, 2, 2);
    if (lua_type(L, 1) == LUA_TNUMBER && lua_type(L, 2) == LUA_TNUMBER) {
        lua_pushnumber(L, op->number(lua_tonumber(L, 1), lua_tonumber(L, 2)));
        return 1;
    }
    hewn_node a = hewn_lua_operand(L, 1, op->name), b = hewn_lua_operand(L, 2, op->name);
    return hewn_lua_push_field(L, op->node(field_of(L), a, b));
}

/* min and max of any number of arguments, from the left; numbers among them are put together first only where they
 * stand together at the front, so that the graph is what was written. */
static int call_fold(lua_State *L)
{
    const binary *op = &folds[lua_tointeger(L, lua_upvalueindex(1))];
    int count = lua_gettop(L), i = 1;
    hewn_lua_check_count(L, op->name, 1, 1 << 24);
    double sum = 0;
    for (; i <= count && lua_type(L, i) == LUA_TNUMBER; i++)
        sum = i == 1 ? lua_tonumber(L, 1) : op->number(sum, lua_tonumber(L, i));
    if (i > count) {
        lua_pushnumber(L, sum);
        return 1;
    }
    if (isnan(sum))
        return luaL_error(L, "%s: a number among the arguments is NaN", op->name);
    hewn_node node = i > 1 ? hewn_constant(field_of(L), sum) : hewn_lua_operand(L, i++, op->name);
    for (; i <= count; i++)
        node = op->node(field_of(L), node, hewn_lua_operand(L, i, op->name));
    return hewn_lua_push_field(L, node);
}

/* --- operators -----------------------------------------------------------------------------------------------------
 */

static const binary operators[] = {
    {"+", NULL, hewn_add}, {"-", NULL, hewn_sub}, {"*", NULL, hewn_mul}, {"/", NULL, hewn_div}, {"%", NULL, hewn_mod},
};
static const char *const operator_events[] = {"__add", "__sub", "__mul", "__div", "__mod"};

static int call_operator(lua_State *L)
{
    const binary *op = &operators[lua_tointeger(L, lua_upvalueindex(1))];
    hewn_node a = hewn_lua_operand(L, 1, op->name), b = hewn_lua_operand(L, 2, op->name);
    return hewn_lua_push_field(L, op->node(field_of(L), a, b));
}

static int negate(lua_State *L)
{
    return hewn_lua_push_field(L, hewn_neg(field_of(L), hewn_lua_field(L, 1, "-")));
}

/* a ^ n for whole n: what is written as powers of coordinates. */
static int power(lua_State *L)
{
    enum { HIGHEST = 64 };
    double exponent = lua_tonumber(L, 2);
    if (!hewn_lua_is_field(L, 1) || lua_type(L, 2) != LUA_TNUMBER || exponent != floor(exponent) || exponent < 1 ||
        exponent > HIGHEST)
        return luaL_error(L, "^ takes a field and a whole number from 1 to %d; exp(b * ln(a)) makes other powers",
                          (int)HIGHEST);
    hewn_field *field = field_of(L);
    hewn_node base = hewn_lua_field(L, 1, "^"), node = base;
    int n = (int)exponent, bit = 1;
    while (bit * 2 <= n)
        bit *= 2;
    while (bit >>= 1) {
        node = hewn_square(field, node);
        if (n & bit)
            node = hewn_mul(field, node, base);
    }
    return hewn_lua_push_field(L, node);
}

static void add_closure(lua_State *L, int methods, const char *name, lua_CFunction function, size_t index)
{
    lua_pushinteger(L, (lua_Integer)index);
    lua_pushcclosure(L, function, 1);
    lua_pushvalue(L, -1);
    lua_setfield(L, methods, name);
    lua_setglobal(L, name);
}

void hewn_lua_open_arithmetic(lua_State *L, int methods)
{
    for (size_t i = 0; i < sizeof unaries / sizeof unaries[0]; i++)
        add_closure(L, methods, unaries[i].name, call_unary, i);
    for (size_t i = 0; i < sizeof binaries / sizeof binaries[0]; i++)
        add_closure(L, methods, binaries[i].name, call_binary, i);
    for (size_t i = 0; i < sizeof folds / sizeof folds[0]; i++)
        add_closure(L, methods, folds[i].name, call_fold, i);
    luaL_getmetatable(L, "field");
    for (size_t i = 0; i < sizeof operators / sizeof operators[0]; i++) {
        lua_pushinteger(L, (lua_Integer)i);
        lua_pushcclosure(L, call_operator, 1);
        lua_setfield(L, -2, operator_events[i]);
    }
    lua_pushcfunction(L, negate);
    lua_setfield(L, -2, "__unm");
    lua_pushcfunction(L, power);
    lua_setfield(L, -2, "__pow");
    lua_pop(L, 1);
}
