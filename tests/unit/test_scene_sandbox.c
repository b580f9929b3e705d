/* Hostile scripts: each must end soon, with an error, without a crash and within its memory. */
#include <time.h>

#include "test_scene.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

/* Loads under tight limits and gives the processor time that it took. */
static double load_limited(const char *text, hewn_error *error)
{
    hewn_scene_desc desc = {.path = "scene.lua",
                            .format = HEWN_SCENE_LUA,
                            .instruction_limit = 2000000,
                            .memory_limit = (uint64_t)16 << 20};
    hewn_scene *scene = (hewn_scene *)1;
    *error = (hewn_error){0};
    clock_t begin = clock();
    hewn_result result = hewn_scene_load_text(&desc, text, strlen(text), &scene, error);
    double seconds = (double)(clock() - begin) / CLOCKS_PER_SEC;
    if (result != HEWN_BAD_INPUT || scene != NULL)
        fail_msg("%s\ngave %s", text, hewn_result_name(result));
    return seconds;
}

/* A script and what the message must have in it. */
typedef struct hostile {
    const char *part;
    const char *text;
} hostile;

static void run_all(const hostile *scripts, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        hewn_error error;
        double seconds = load_limited(scripts[i].text, &error);
        /* On a slow machine, or under a sanitizer, the limit of time can come first. */
        if (!strstr(error.message, scripts[i].part) && !strstr(error.message, "processor time"))
            fail_msg("%s\ngave %s:%u: %s\nexpected ...%s...", scripts[i].text, error.file, error.line, error.message,
                     scripts[i].part);
        if (seconds > 10)
            fail_msg("%s\ntook %.1f s", scripts[i].text, seconds);
        assert_string_equal(error.file, "scene.lua");
    }
}

static void test_endless(void **state)
{
    (void)state;
    static const hostile scripts[] = {
        {"endless loop", "while true do end"},
        {"endless loop", "goto a ::a:: goto a"},
        {"endless loop", "::a:: goto a"},
        {"endless loop", "repeat until false"},
        {"endless loop", "local function f() return f() end f()"},
        {"endless loop", "for i = 1, math.huge do end"},
        {"endless loop", "while true do pcall(function() while true do end end) end"},
        {"endless loop",
         "while true do xpcall(function() while true do end end, function() while true do end end) end"},
        {"endless loop", "local function f() pcall(f) while true do end end f()"},
        {"the scene ", "local function f() pcall(f) pcall(f) end f() while true do end"},
        {"endless loop", "while true do pcall(error) end"},
        {"endless loop", "pcall(pcall, pcall, function() while true do end end) while true do end"},
        {"endless loop", "local t = setmetatable({}, {__index = function(t, k) while true do end end}) return t.a"},
        {"endless loop", "local t = setmetatable({}, {__close = function() while true do end end}) "
                         "do local a <close> = t end"},
        {"endless loop", "local t = setmetatable({}, {__close = function() while true do end end}) "
                         "pcall(function() local a <close> = t error('x') end) while true do end"},
        {"endless loop", "table.sort({3, 2, 1}, function() while true do end end)"},
        {"endless loop", "('aaa'):gsub('a', function() while true do end end)"},
        {"endless loop", "tostring(setmetatable({}, {__tostring = function() while true do end end}))"},
        {"endless loop", "print(setmetatable({}, {__tostring = function() while true do end end}))"},
        {"endless loop", "for k in pairs(setmetatable({}, {__pairs = function() while true do end end})) do end"},
        {"endless loop", "for k in function() return 1 end do end"},
        {"endless loop", "load = nil while true do local t = {} t[1] = t end"},
        {"endless loop", "local x = x while true do x = x:move(0, 0, 0) end"},
    };
    run_all(scripts, COUNT(scripts));
}

/* Work inside C functions, where no instruction is counted. */
static void test_long_calls(void **state)
{
    (void)state;
    static const hostile scripts[] = {
        {"could take too long", "(('a'):rep(1000)):find(('.-'):rep(20) .. 'b')"},
        {"could take too long", "(('a'):rep(30)):match(('a?'):rep(30) .. ('a'):rep(30))"},
        {"could take too long", "(('x'):rep(100000)):gsub('.-.-b', '')"},
        {"could take too long", "for w in (('x'):rep(100000)):gmatch('%b()*x-') do end"},
        {"pattern is longer", "(''):find(('a'):rep(300))"},
        {"string.rep", "('x'):rep(1 << 40)"},
        {"string.rep", "('x'):rep(math.maxinteger, 'yyy')"},
        {"more than 1048576 items", "table.move({}, 1, math.maxinteger - 1, 2)"},
        {"more than 1048576 items", "table.move({}, math.mininteger, math.maxinteger, 1)"},
        {"more than 1048576 items", "table.concat(setmetatable({}, {__index = table.concat}), '', 1, 1 << 60)"},
        {"more than 1048576 items", "table.unpack({}, 1, 1 << 60)"},
        {"__len", "table.insert(setmetatable({}, {__len = function() return 1 << 60 end}), 1, 1)"},
        {"__len", "table.sort(setmetatable({}, {__len = function() return 1 << 30 end}), print)"},
        {"returned nothing", "local t = {} local i = 1 while i > 0 do t[i] = 1 i = i * 2 end table.insert(t, 1, 1)"},
        {"processor time",
         "local a = ('\\0'):rep(1 << 20) local b = ('\\0'):rep(1 << 20) while a <= b do end return x"},
        {"processor time", "local a = ('0'):rep(1 << 20) while true do local b = a + 1 end return x"},
        {"processor time", "while true do local s = ('x'):rep(1 << 20) end"},
        {"processor time", "local t = {} for i = 1, 10000 do t[i] = i end while true do table.concat(t, ',') end"},
        {"processor time", "local s = ('x'):rep(1000) while true do s:find('.-y') end"},
        {"processor time",
         "local f = x for i = 1, 4000 do f = min(f, abs(y - i)) end while true do f:move(1, 2, 0.5) end"},
        {"a scene's tables cannot have __mode", "setmetatable({}, {__mode = 'k'})"},
        {"a scene's tables cannot have __gc", "setmetatable({}, {__gc = function() while true do end end})"},
    };
    run_all(scripts, COUNT(scripts));
}

static void test_memory(void **state)
{
    (void)state;
    static const hostile scripts[] = {
        {"MiB of memory", "local t = {} while true do t[#t + 1] = {} end"},
        {"MiB of memory", "local t = {} while true do t[#t + 1] = ('x'):rep(100000) .. #t end"},
        {"MiB of memory", "local t = {} pcall(function() while true do t[#t + 1] = {} end end) return x"},
        {"MiB of memory", "local t = {} while true do pcall(function() while true do t[#t + 1] = {} end end) end"},
        {"MiB of memory", "local f = x for i = 1, 1e9 do f = f + i * y end return f"},
        {"MiB of memory", "local f = x + y * z for i = 1, 60 do f = f:remap(f, f + i, z) end return f"},
        {"too large", "local s = ('x'):rep(1 << 19) return s .. s .. s"},
        {"too large", "local s = 'x' while true do s = s .. s end"},
        {"too large", "local s = 'x' while true do pcall(function() s = s .. s end) end"},
        {"too large", "local t = {} for i = 1, 3e3 do t[i] = ('x'):rep(1000) end return table.concat(t)"},
        {"MiB of memory", "(('x'):rep(1000)):gsub('', ('y'):rep(1 << 20))"},
        {"MiB of memory", "local function f() return 1 + f() end f()"},
        {"the scene ", "local function f() pcall(f) return 1 + f() end f() error('over and over')"},
        {"overflow", "local s = setmetatable({}, {__index = "
                     "function(s, k) return s[k] end}) return s.a"},
    };
    run_all(scripts, COUNT(scripts));
}

/* Deeply nested text must be refused by the parser, and long chains must not keep it busy. */
static void test_parser(void **state)
{
    (void)state;
    static const struct {
        const char *begin, *again;
        size_t times;
    } texts[] = {
        {"return ", "(", 100000},
        {"return ", "{", 100000},
        {"return ", "-", 100000},
        {"return ", "f(", 100000},
        {"", "do ", 100000},
        {"return a", ".a", 400000},
        {"return a", " or a", 400000},
        {"return x and a", " and a", 400000},
        {"if a then", " elseif a then", 100000},
        {"local a", "=a local a", 100000},
        {"", "goto a ", 100000},
        {"", "function f() ", 10000},
        {"return '", "\\z ", 100000},
        {"return [", "=", 100000},
        {"return ", "'a'..", 100000},
        {"return ", "2^", 100000},
    };
    for (size_t i = 0; i < COUNT(texts); i++) {
        size_t length = strlen(texts[i].again);
        char *text = calloc(strlen(texts[i].begin) + length * texts[i].times + 1, 1);
        assert_non_null(text);
        char *at = text + sprintf(text, "%s", texts[i].begin);
        for (size_t j = 0; j < texts[i].times; j++)
            memcpy(at + j * length, texts[i].again, length);
        hewn_error error;
        double seconds = load_limited(text, &error);
        free(text);
        if (seconds > 10)
            fail_msg("%s%s... took %.1f s", texts[i].begin, texts[i].again, seconds);
    }
}

/* What a scene must not find. */
static void test_nothing_dangerous(void **state)
{
    (void)state;
    static const char *const absent[] = {"io",
                                         "os",
                                         "package",
                                         "debug",
                                         "coroutine",
                                         "load",
                                         "dofile",
                                         "require",
                                         "collectgarbage",
                                         "loadfile",
                                         "loadstring",
                                         "warn",
                                         "string.dump",
                                         "getmetatable('').__gc",
                                         "_G.io",
                                         "module",
                                         "setfenv",
                                         "table.foreach"};
    for (size_t i = 0; i < COUNT(absent); i++) {
        char text[200];
        snprintf(text, sizeof text, "assert(%s == nil) return x", absent[i]);
        hewn_scene *scene = test_load_lua(text);
        hewn_scene_destroy(&scene);
    }
    test_refused("return x.node", HEWN_SCENE_LUA, 1, "a field has no method 'node'");
    test_refused("return x[1]", HEWN_SCENE_LUA, 1, "methods only");
    test_refused("\x1bLua", HEWN_SCENE_LUA, 1, "compiled Lua");
    test_refused("local function f() return 1 + f() end\nf()", HEWN_SCENE_LUA, 1, "stack overflow");
    test_refused("x.a = 1", HEWN_SCENE_LUA, 1, "field");
    test_refused("setmetatable(x, {})", HEWN_SCENE_LUA, 1, "table expected");
    test_refused("getmetatable(x).__index = nil", HEWN_SCENE_LUA, 1, "attempt to index a string value");
}

/* Every byte of memory is asked for and given back under limits from nothing to plenty: no crash in between. */
static void test_every_memory_limit(void **state)
{
    (void)state;
    static const char text[] = "local t = {} for i = 1, 50 do t[i] = sphere(i):move(i, 0, 0) end\n"
                               "local ok, e = pcall(error, {}) local s = ('ab'):rep(100) .. tostring(t)\n"
                               "return union(table.unpack(t)) | box(param('size', 2)) & ~torus(2, 1)";
    uint64_t step = getenv("HEWN_LONG") ? 61 : 1021;
    bool loaded = false;
    for (uint64_t limit = 1; limit < 200000; limit += step) {
        hewn_scene_desc desc = {.path = "scene.lua", .format = HEWN_SCENE_LUA, .memory_limit = limit};
        hewn_scene *scene;
        hewn_error error = {0};
        hewn_result result = hewn_scene_load_text(&desc, text, strlen(text), &scene, &error);
        loaded = result == HEWN_OK;
        if (loaded)
            hewn_scene_destroy(&scene);
        else if (result != HEWN_BAD_INPUT || error.message[0] == '\0')
            fail_msg("at %llu bytes: %s, %s", (unsigned long long)limit, hewn_result_name(result), error.message);
    }
    assert_true(loaded);
}

static void test_every_instruction_limit(void **state)
{
    (void)state;
    static const char text[] = "local n = 0 for i = 1, 2000 do pcall(function() n = n + i end) end\n"
                               "assert(n == 2001000) return x + n";
    bool loaded = false;
    for (uint64_t limit = 1; limit < 60000; limit += 997) {
        hewn_scene_desc desc = {.path = "scene.lua", .format = HEWN_SCENE_LUA, .instruction_limit = limit};
        hewn_scene *scene;
        hewn_error error = {0};
        hewn_result result = hewn_scene_load_text(&desc, text, strlen(text), &scene, &error);
        loaded = result == HEWN_OK;
        if (loaded)
            hewn_scene_destroy(&scene);
        else if (result != HEWN_BAD_INPUT || !strstr(error.message, "instructions") || error.line != 1)
            fail_msg("at %llu: %s, line %u: %s", (unsigned long long)limit, hewn_result_name(result), error.line,
                     error.message);
    }
    assert_true(loaded);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_endless),
        cmocka_unit_test(test_long_calls),
        cmocka_unit_test(test_memory),
        cmocka_unit_test(test_parser),
        cmocka_unit_test(test_nothing_dangerous),
        cmocka_unit_test(test_every_memory_limit),
        cmocka_unit_test(test_every_instruction_limit),
    };
    return cmocka_run_group_tests_name("scene_sandbox", tests, NULL, NULL);
}
