/* SPDX-License-Identifier: Apache-2.0 */
/* The grammar of world files: what is read, what is refused and where, and that garbage ends. */
#include "core/random.h"
#include "hush.h"
#include "suite.h"
#include "world/parse/parser.h"

#include <CUnit/Basic.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static struct world_file file;
static struct mu_fault fault;
static char big[WORLDFILE_TEXT_MAX];

static mu_result parse(const char *text)
{
    fault = (struct mu_fault){0};
    int kept = hush();
    mu_result r = worldfile_parse_text(&file, "/tmp/t.world", text, strlen(text), &fault);
    unhush(kept);
    return r;
}

static void test_properties_and_models(void)
{
    CU_ASSERT_EQUAL_FATAL(parse("\xef\xbb\xbf# a comment\r\n"
                                "speed -1.5e1 name \"x y\" color red\n"
                                "thing ( size[1 2] point[3] [.5 +2 b \"c\"] inner() )"),
                          MU_OK);
    const struct worldfile_property *p = worldfile_property(&file.root, "speed");
    CU_ASSERT_PTR_NOT_NULL_FATAL(p);
    CU_ASSERT_EQUAL(p->value_count, 1);
    CU_ASSERT_EQUAL(p->values[0].number, -15);
    CU_ASSERT_EQUAL(p->at.line, 2);
    CU_ASSERT_EQUAL(p->at.column, 1);
    CU_ASSERT_STRING_EQUAL(worldfile_property(&file.root, "name")->values[0].text, "x y");
    CU_ASSERT_STRING_EQUAL(worldfile_property(&file.root, "color")->values[0].text, "red");
    const struct worldfile_entity *thing = file.root.children;
    CU_ASSERT_PTR_NOT_NULL_FATAL(thing);
    CU_ASSERT_STRING_EQUAL(thing->type, "thing");
    CU_ASSERT_EQUAL(worldfile_property(thing, "size")->value_count, 2);
    p = thing->last_property;
    CU_ASSERT_STRING_EQUAL(p->key, "point");
    CU_ASSERT_EQUAL(p->index, 3);
    CU_ASSERT_EQUAL(p->value_count, 4);
    CU_ASSERT_EQUAL(p->values[0].number, 0.5);
    CU_ASSERT_STRING_EQUAL(p->values[2].text, "b");
    CU_ASSERT_STRING_EQUAL(thing->children->type, "inner");
}

static void test_definitions(void)
{
    CU_ASSERT_EQUAL_FATAL(parse("define a model ( mass 1 color red mass 2 )\n"
                                "define b a ( mass 3 )\n"
                                "b ( )\n"
                                "define b a ( mass 4 )\n"
                                "b ( color blue )\n"
                                "later ( )\n"
                                "define later a ( )"),
                          MU_OK);
    const struct worldfile_entity *first = file.root.children;
    CU_ASSERT_STRING_EQUAL(worldfile_kind(first), "model");
    CU_ASSERT_EQUAL(worldfile_property(first, "mass")->values[0].number, 3);
    CU_ASSERT_STRING_EQUAL(worldfile_property(first, "color")->values[0].text, "red");
    CU_ASSERT_PTR_NULL(worldfile_property(first, "pose"));
    const struct worldfile_entity *second = first->next;
    CU_ASSERT_EQUAL(worldfile_property(second, "mass")->values[0].number, 4);
    CU_ASSERT_STRING_EQUAL(worldfile_property(second, "color")->values[0].text, "blue");
    CU_ASSERT_STRING_EQUAL(worldfile_kind(second->next), "later"); /* not defined before */
    CU_ASSERT_EQUAL(worldfile_property(worldfile_definition(&file, "a"), "mass")->values[0].number,
                    2);
}

static void test_faults_say_where_and_what(void)
{
    static const struct {
        const char *text;
        int line, column;
        const char *says;
    } cases[] = {
        {"a ( b 1", 1, 8, "expected ')' to end 'a' of line 1, found the end of the file"},
        {"a\n(\n  b ]\n)", 3, 5, "expected a value or '(', found ']'"},
        {")", 1, 1, "expected a property or a model, found ')'"},
        {"a ( \"x\" )", 1, 5, "expected a property, a model or ')', found \"x\""},
        {"a [ 1 (", 1, 7, "expected a number, a text or ']', found '('"},
        {"a [ 1", 1, 6, "expected a number, a text or ']', found the end of the file"},
        {"name \"open\nb 1", 1, 6, "expected '\"' at the end of the text, before the line ends"},
        {"a 1e999", 1, 3, "expected a finite number, found one that is too large"},
        {"a 12abc", 1, 3, "expected a number"},
        {"a 0x10", 1, 3, "expected a number"},
        {"a -", 1, 3, "expected a number"},
        {"a @", 1, 3, "expected a name, a value or a bracket, found a stray character"},
        {"a ( color b ( ) )", 1, 5, "expected a value for 'color'"},
        {"define", 1, 7, "expected the name that is defined, found the end of the file"},
        {"define a 3 ( )", 1, 10, "expected the model that the new one derives from, found '3'"},
        {"define a b c", 1, 12, "expected '(', found 'c'"},
        {"a ( define b c ( ) )", 1, 5, "expected a property, a model or ')', found 'define'"},
        {"include here", 1, 9, "expected the file to include, in quotes, found 'here'"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        CU_ASSERT_EQUAL(parse(cases[i].text), MU_FAULT_FILE);
        CU_ASSERT_EQUAL(fault.line, cases[i].line);
        CU_ASSERT_EQUAL(fault.column, cases[i].column);
        CU_ASSERT_STRING_EQUAL(fault.text, cases[i].says);
        CU_ASSERT_STRING_EQUAL(fault.file, "/tmp/t.world");
    }
}

static void test_include_is_beside_the_file(void)
{
    char path[] = "/tmp/muster-world-XXXXXX";
    int fd = mkstemp(path);
    CU_ASSERT_FATAL(fd >= 0);
    CU_ASSERT_EQUAL(write(fd, "define a model ( mass 5 )\n%", 27), 27);
    char text[128];
    snprintf(text, sizeof text, "include \"%s\" a ( )", strrchr(path, '/') + 1);
    CU_ASSERT_EQUAL(parse(text), MU_FAULT_FILE); /* a fault in the included file bears its name */
    CU_ASSERT_STRING_EQUAL(fault.file, path);
    CU_ASSERT_EQUAL(fault.line, 2);
    CU_ASSERT_EQUAL(ftruncate(fd, 26), 0);
    CU_ASSERT_EQUAL(parse(text), MU_OK);
    CU_ASSERT_EQUAL(worldfile_property(file.root.children, "mass")->values[0].number, 5);
    CU_ASSERT_EQUAL(ftruncate(fd, 0), 0);
    lseek(fd, 0, SEEK_SET);
    CU_ASSERT_EQUAL(write(fd, text, strlen(text)), (ssize_t)strlen(text)); /* includes itself */
    CU_ASSERT_EQUAL(parse(text), MU_FAULT_FILE);
    CU_ASSERT_PTR_NOT_NULL(strstr(fault.text, "include one another"));
    close(fd);
    unlink(path);
    CU_ASSERT_EQUAL(parse("\n include \"muster-no-such.inc\""), MU_FAULT_FILE);
    CU_ASSERT_EQUAL(fault.line, 2);
    CU_ASSERT_EQUAL(fault.column, 10);
    const char *says = "cannot read the file '/tmp/muster-no-such.inc': No such file or directory; "
                       "muster's own are in ";
    CU_ASSERT_NSTRING_EQUAL(fault.text, says, strlen(says));
    CU_ASSERT_EQUAL(access(fault.text + strlen(says), R_OK), 0); /* the folder is there */
    CU_ASSERT_EQUAL(parse("include \"/dev/zero\""), MU_FAULT_FILE);
    CU_ASSERT_EQUAL(parse("include \"/tmp\""), MU_FAULT_FILE);
}

/* Repeats a piece so many times, between a head and a tail. */
static mu_result parse_many(const char *head, const char *piece, size_t times, const char *tail)
{
    size_t len = 0;
    size_t parts = times + 2;
    for (size_t i = 0; i < parts; i++) {
        const char *part = i == 0 ? head : i == parts - 1 ? tail : piece;
        size_t part_len = strlen(part);
        CU_ASSERT_FATAL(len + part_len < sizeof big);
        memcpy(big + len, part, part_len);
        len += part_len;
    }
    big[len] = '\0';
    return parse(big);
}

static void test_limits(void)
{
    CU_ASSERT_EQUAL(parse_many("a [", " 1", WORLDFILE_TUPLE_MAX, "]"), MU_OK);
    CU_ASSERT_EQUAL(parse_many("a [", " 1", WORLDFILE_TUPLE_MAX + 1, "]"), MU_FAULT_FILE);
    CU_ASSERT_EQUAL(parse_many("", "a 1 ", WORLDFILE_PROPERTIES_MAX, ""), MU_OK);
    CU_ASSERT_EQUAL(parse_many("", "a 1 ", WORLDFILE_PROPERTIES_MAX + 1, ""), MU_FAULT_FILE);
    CU_ASSERT_EQUAL(parse_many("", "define x model() ", WORLDFILE_DEFINITIONS_MAX, ""), MU_OK);
    CU_ASSERT_EQUAL(parse_many("", "define x model() ", WORLDFILE_DEFINITIONS_MAX + 1, ""),
                    MU_FAULT_FILE);
    CU_ASSERT_EQUAL(parse_many("define x model() ", "define x x() ", WORLDFILE_DERIVATION_MAX, ""),
                    MU_OK);
    CU_ASSERT_EQUAL(
        parse_many("define x model() ", "define x x() ", WORLDFILE_DERIVATION_MAX + 1, ""),
        MU_FAULT_FILE);
    CU_ASSERT_EQUAL(parse_many("", "a(", WORLDFILE_NESTING_MAX + 1, ""), MU_FAULT_FILE);
    CU_ASSERT_PTR_NOT_NULL(strstr(fault.text, "nest deeper"));
    CU_ASSERT_EQUAL(parse_many("", "a(", WORLDFILE_NESTING_MAX, ""), MU_FAULT_FILE);
    CU_ASSERT_PTR_NOT_NULL(strstr(fault.text, "expected ')'"));
    CU_ASSERT_EQUAL(parse_many("", "a()", 1000000, ""), MU_FAULT_FILE);
    CU_ASSERT_PTR_NOT_NULL(strstr(fault.text, "too large"));
}

static const char sample[] = "define bot position ( size [0.4 0.3] mass 3 # kg\n"
                             "  ranger ( sensor ( pose [0.1 0 0 90] samples 1 ) ) )\n"
                             "model ( name \"hall\" boundary 1 block ( points 3 point[0] [0 0]\n"
                             "  point[1] [1 0] point[2] [0 1] z [0 1] ) )\n"
                             "bot ( name \"red\" pose [1 -2.5e0 0 45] color blue )\n";

/* Whatever is cut off or garbled: parsing ends, says the same twice, and names a place. */
static void test_garbage_is_refused_or_read(void)
{
    struct mu_random random;
    mu_random_seed(&random, 1, "garbage");
    size_t refused = 0;
    size_t unequal = 0;
    size_t placeless = 0;
    int kept = hush();
    for (size_t round = 0; round < 4000; round++) {
        char text[sizeof sample];
        memcpy(text, sample, sizeof sample);
        size_t len = sizeof sample - 1;
        if (round < len) {
            len = round;
        } else {
            for (int64_t n = mu_random_between(&random, 1, 8); n > 0; n--) {
                int64_t at = mu_random_between(&random, 0, (int64_t)len - 1);
                static const char marks[] = "()[]\"#.-+e0 \n";
                int64_t mark = mu_random_between(&random, 0, 25);
                text[at] = mark < 13 ? marks[mark] : (char)mu_random_between(&random, 0, 255);
            }
        }
        struct mu_fault first = {0};
        struct mu_fault second = {0};
        mu_result a = worldfile_parse_text(&file, "t", text, len, &first);
        mu_result b = worldfile_parse_text(&file, "t", text, len, &second);
        unequal += a != b || strcmp(first.text, second.text) != 0 || first.line != second.line ||
                   first.column != second.column;
        placeless += a != MU_OK && (first.line < 1 || first.column < 1 || first.text[0] == '\0');
        refused += a != MU_OK;
    }
    unhush(kept);
    CU_ASSERT_EQUAL(unequal, 0);
    CU_ASSERT_EQUAL(placeless, 0);
    CU_ASSERT(refused > 1000);
    CU_ASSERT_EQUAL(parse(sample), MU_OK);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"properties and models", test_properties_and_models},
        {"definitions derive and replace", test_definitions},
        {"faults say where and what", test_faults_say_where_and_what},
        {"include is beside the file", test_include_is_beside_the_file},
        {"limit: each is refused", test_limits},
        {"garbage is refused or read", test_garbage_is_refused_or_read},
        CU_TEST_INFO_NULL,
    };
    worldfile_init(&file);
    return suite_run("world/parser", tests);
}
