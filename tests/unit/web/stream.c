/* SPDX-License-Identifier: Apache-2.0 */
/* What one viewer gets: each event whole, of the board the newest, and word of what it missed. */
#include "muster/memory.h"
#include "suite.h"
#include "web/web.h"

#include <CUnit/Basic.h>
#include <stdlib.h>
#include <string.h>

static struct board board;
static struct stream stream;
static char got[2 * BOARD_EVENT_MAX];

static void put(enum board_item item, const char *key, int value)
{
    struct mu_json *j = board_begin(&board, item);
    mu_json_object(j, NULL);
    mu_json_int(j, key, value);
    mu_json_end(j);
    (void)board_end(&board);
}

static mu_result own_put(const char *name, const char *value)
{
    static char bytes[STREAM_QUEUE_BYTES + 64];
    struct mu_text text;
    struct mu_json j;
    mu_text_init(&text, bytes, sizeof bytes);
    board_event_begin(&text, &j, name);
    mu_json_object(&j, NULL);
    mu_json_string(&j, "text", value);
    mu_json_end(&j);
    board_event_end(&text);
    return stream_put(&stream, &text);
}

/* Reads all that there is, in pieces of that size.  @return what it was */
static const char *read_all(size_t piece)
{
    size_t len = 0, more;
    while ((more = stream_read(&stream, &board, got + len, piece)) > 0) {
        CU_ASSERT_TRUE(more <= piece);
        len += more;
    }
    got[len] = '\0';
    return got;
}

static void begin(void)
{
    memset(&board.items[0].version, 0, sizeof board.items[0].version);
    for (int i = 0; i < BOARD_ITEMS; i++) {
        board.items[i].version = 0;
        mu_text_clear(&board.items[i].text);
    }
    stream_clear(&stream);
}

static void test_events_are_written_as_they_are_sent(void)
{
    begin();
    put(BOARD_FRAME, "step", 7);
    READS(read_all(1000), "event: frame\ndata: {\"step\": 7}\n\n");
    READS(read_all(1000), "");
    CU_ASSERT_FALSE(stream_has(&stream, &board));
}

static void test_what_was_dropped_nobody_sees(void)
{
    begin();
    put(BOARD_FRAME, "step", 1);
    (void)read_all(1000);
    put(BOARD_FRAME, "step", 2);
    board_drop(&board, BOARD_FRAME);
    CU_ASSERT_FALSE(stream_has(&stream, &board));
    READS(read_all(1000), "");
    put(BOARD_FRAME, "step", 1); /* of another run, and new although it is as the first was */
    READS(read_all(1000), "event: frame\ndata: {\"step\": 1}\n\n"
                          "event: missed\ndata: {\"frames\": 1, \"answers\": 0}\n\n");
}

static void test_an_event_is_whole_although_the_board_goes_on(void)
{
    begin();
    put(BOARD_FRAME, "step", 1);
    size_t len = stream_read(&stream, &board, got, 20);
    put(BOARD_FRAME, "step", 2);
    size_t more;
    while ((more = stream_read(&stream, &board, got + len, 5)) > 0) {
        len += more;
    }
    got[len] = '\0';
    READS(got, "event: frame\ndata: {\"step\": 1}\n\nevent: frame\ndata: {\"step\": 2}\n\n");
}

static void test_who_is_late_gets_the_newest_and_the_count_of_the_rest(void)
{
    begin();
    put(BOARD_FRAME, "step", 1);
    (void)read_all(1000);
    for (int step = 2; step <= 100; step++) {
        put(BOARD_FRAME, "step", step);
    }
    READS(read_all(13), "event: frame\ndata: {\"step\": 100}\n\n"
                        "event: missed\ndata: {\"frames\": 98, \"answers\": 0}\n\n");
}

static void test_a_new_viewer_has_missed_nothing(void)
{
    begin();
    put(BOARD_FRAME, "step", 1);
    put(BOARD_FRAME, "step", 2);
    READS(read_all(1000), "event: frame\ndata: {\"step\": 2}\n\n");
}

static void test_what_has_not_changed_is_not_sent(void)
{
    begin();
    put(BOARD_RUN, "step", 1);
    (void)read_all(1000);
    put(BOARD_RUN, "step", 1);
    READS(read_all(1000), "");
}

static void test_what_comes_often_leaves_room_for_the_rest(void)
{
    char one[BOARD_EVENT_MAX];
    bool had_agents = false;
    begin();
    put(BOARD_AGENTS, "agents", 4);
    for (int i = 0; i < BOARD_ITEMS && !had_agents; i++) {
        put(BOARD_RUN, "step", i);
        put(BOARD_FRAME, "step", i);
        size_t len = stream_read(&stream, &board, one, sizeof one - 1);
        one[len] = '\0';
        had_agents = strstr(one, "event: agents") != NULL;
    }
    CU_ASSERT_TRUE(had_agents);
}

static void test_own_events_come_in_order_before_the_board(void)
{
    begin();
    put(BOARD_FRAME, "step", 1);
    CU_ASSERT_EQUAL(own_put("said", "a"), MU_OK);
    CU_ASSERT_EQUAL(own_put("said", "b"), MU_OK);
    READS(read_all(7), "event: said\ndata: {\"text\": \"a\"}\n\n"
                       "event: said\ndata: {\"text\": \"b\"}\n\n"
                       "event: frame\ndata: {\"step\": 1}\n\n");
}

static void test_a_full_queue_refuses_and_tells(void)
{
    static char long_text[100 * 1024];
    unsigned put_count = 0;
    begin();
    memset(long_text, 'x', sizeof long_text - 1);
    while (own_put("said", long_text) == MU_OK) {
        put_count++;
    }
    CU_ASSERT_EQUAL(put_count, STREAM_QUEUE_BYTES / sizeof long_text);
    CU_ASSERT_EQUAL(stream.lost, 1);
    CU_ASSERT_PTR_NOT_NULL(strstr(read_all(4096), "\"answers\": 1"));
    CU_ASSERT_EQUAL(own_put("said", "again"), MU_OK);
    READS(read_all(4096), "event: said\ndata: {\"text\": \"again\"}\n\n");
}

static void test_what_is_longer_than_an_event_is_left_out(void)
{
    begin();
    put(BOARD_AGENTS, "agents", 1);
    struct mu_json *j = board_begin(&board, BOARD_AGENTS);
    mu_json_list(j, NULL);
    for (int i = 0; i < BOARD_EVENT_MAX / 8; i++) {
        mu_json_int(j, NULL, 12345678);
    }
    mu_json_end(j);
    uint64_t before = board.cut;
    CU_ASSERT_EQUAL(board_end(&board), BOARD_CUT);
    CU_ASSERT_EQUAL(board.cut, before + 1);
    READS(read_all(4096), "event: agents\ndata: {\"agents\": 1}\n\n");
}

/* The format of events knows lines: a line of a stranger's must not look like one of ours. */
static void test_no_text_can_end_an_event(void)
{
    begin();
    CU_ASSERT_EQUAL(own_put("said", "a\n\nevent: hello\r\ndata: {}\r\n\r\n"), MU_OK);
    const char *sent = read_all(1000);
    READS(sent, "event: said\ndata: {\"text\": \"a\\n\\nevent: hello\\r\\ndata: "
                "{}\\r\\n\\r\\n\"}\n\n");
}

int main(void)
{
    board_init(&board);
    stream_init(&stream);
    mu_memory_seal();
    CU_TestInfo tests[] = {
        {"events are written as they are sent", test_events_are_written_as_they_are_sent},
        {"what was dropped nobody sees", test_what_was_dropped_nobody_sees},
        {"an event is whole although the board goes on",
         test_an_event_is_whole_although_the_board_goes_on},
        {"who is late gets the newest and the count of the rest",
         test_who_is_late_gets_the_newest_and_the_count_of_the_rest},
        {"a new viewer has missed nothing", test_a_new_viewer_has_missed_nothing},
        {"what has not changed is not sent", test_what_has_not_changed_is_not_sent},
        {"what comes often leaves room for the rest",
         test_what_comes_often_leaves_room_for_the_rest},
        {"own events come in order before the board",
         test_own_events_come_in_order_before_the_board},
        {"a full queue refuses and tells", test_a_full_queue_refuses_and_tells},
        {"what is longer than an event is left out", test_what_is_longer_than_an_event_is_left_out},
        {"no text can end an event", test_no_text_can_end_an_event},
        CU_TEST_INFO_NULL,
    };
    return suite_run("web/stream", tests);
}
