/* SPDX-License-Identifier: Apache-2.0 */
/* The white pages as the page has them: parts that replace each other, of one broker and of two. */
#include "muster/memory.h"
#include "samples.h"
#include "suite.h"
#include "web/json.h"

#include <CUnit/Basic.h>
#include <stdio.h>
#include <string.h>

static struct pages *pages;
static char bytes[256 * 1024];

static void part(const char *broker, uint32_t number, const char *const *lines)
{
    char *at[8];
    uint32_t count = 0;
    for (; lines[count]; count++) {
        at[count] = words(lines[count]);
    }
    muster_Page page = {.broker = words(broker), .part = number};
    page.lines._buffer = at;
    page.lines._length = count;
    pages_take(pages, &page);
}

#define PART(broker, number, ...) part(broker, number, (const char *const[]){__VA_ARGS__, NULL})
#define EMPTY(broker, number)     part(broker, number, (const char *const[]){NULL})

static const char *written(void)
{
    struct mu_text text;
    struct mu_json j;
    mu_text_init(&text, bytes, sizeof bytes);
    mu_json_to_text(&j, &text, MU_JSON_LINE);
    pages_write(&j, pages);
    return text.at;
}

static void begin(void)
{
    for (uint32_t i = 0; i < pages->count; i++) {
        if (pages->lines[i].name[0]) {
            mu_table_remove(&pages->names, pages->lines[i].name);
        }
    }
    memset(pages->lines, 0, sizeof pages->lines);
    pages->count = 0;
}

static void test_a_part_replaces_itself(void)
{
    begin();
    PART("main", 0, "red robot running main p1 here 12 99", "blue robot standby main p2 - 13 99");
    PART("main", 1, "observer special running main p3 here 14 99");
    READS(written(), "{\"agents\": [[\"red\", \"robot\", \"running\", \"here\", \"\"], "
                     "[\"blue\", \"robot\", \"standby\", \"\", \"\"], "
                     "[\"observer\", \"special\", \"running\", \"here\", \"\"]]}\n");
    PART("main", 0, "blue robot suspended main p2 there 13 99 break: see me");
    READS(written(),
          "{\"agents\": [[\"blue\", \"robot\", \"suspended\", \"there\", \"break: see me\"], "
          "[\"observer\", \"special\", \"running\", \"here\", \"\"]]}\n");
    EMPTY("main", 0);
    READS(written(), "{\"agents\": [[\"observer\", \"special\", \"running\", \"here\", \"\"]]}\n");
}

static void test_of_two_brokers_the_last_word_counts(void)
{
    begin();
    PART("a", 0, "red robot running a p1 here 12 99");
    PART("b", 0, "red robot suspended a p1 here 12 99");
    READS(written(), "{\"agents\": [[\"red\", \"robot\", \"suspended\", \"here\", \"\"]]}\n");
    EMPTY("a", 0); /* its pages are empty, but b's are not */
    READS(written(), "{\"agents\": [[\"red\", \"robot\", \"suspended\", \"here\", \"\"]]}\n");
    EMPTY("b", 0);
    READS(written(), "{\"agents\": []}\n");
}

static void test_people_who_look_are_left_out(void)
{
    begin();
    PART("a", 0, "operator-64 special running a p1 here 12 99",
         "operator special running a p h 1 9");
    CU_ASSERT_PTR_NULL(strstr(written(), "operator-64"));
}

static void test_lines_that_are_none_are_counted(void)
{
    begin();
    uint64_t before = pages->refused;
    PART("a", 0, "", "red", "red robot", "9red robot running a p h 1 9",
         "<script> robot running a p h 1 9");
    CU_ASSERT_EQUAL(pages->refused, before + 5);
    READS(written(), "{\"agents\": []}\n");
}

static void test_there_is_an_end(void)
{
    char line[64];
    begin();
    uint64_t before = pages->refused;
    for (uint32_t i = 0; i < PAGES_LINES_MAX + 3; i++) {
        snprintf(line, sizeof line, "r%u robot running a p h 1 9", (unsigned)i);
        PART("a", i, line);
    }
    CU_ASSERT_EQUAL(pages->refused, before + 3);
    EMPTY("a", 7);
    PART("a", 7, "late robot running a p h 1 9");
    CU_ASSERT_PTR_NOT_NULL(strstr(written(), "\"late\""));
}

int main(void)
{
    pages = mu_startup_alloc(sizeof *pages);
    pages_init(pages);
    mu_memory_seal();
    CU_TestInfo tests[] = {
        {"a part replaces itself", test_a_part_replaces_itself},
        {"of two brokers the last word counts", test_of_two_brokers_the_last_word_counts},
        {"people who look are left out", test_people_who_look_are_left_out},
        {"lines that are none are counted", test_lines_that_are_none_are_counted},
        {"there is an end", test_there_is_an_end},
        CU_TEST_INFO_NULL,
    };
    return suite_run("web/pages", tests);
}
