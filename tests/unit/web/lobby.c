/* SPDX-License-Identifier: Apache-2.0 */
/* Connections without a stream: who waits longest makes room, and nobody waits for ever. */
#include "suite.h"
#include "web/web.h"

#include <stdbool.h>
#include <sys/socket.h>
#include <unistd.h>

enum { PAIRS = LOBBY_MAX + 2 };

static int ours[PAIRS], theirs[PAIRS];
static struct lobby lobby;

static void pairs_open(void)
{
    lobby.count = 0;
    for (size_t i = 0; i < PAIRS; i++) {
        int ends[2];
        CU_ASSERT_EQUAL_FATAL(socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
        ours[i] = ends[0];
        theirs[i] = ends[1];
    }
}

static void pairs_close(void)
{
    for (size_t i = 0; i < PAIRS; i++) {
        close(ours[i]);
        close(theirs[i]);
    }
}

/* @return whether the other end has heard that it is over */
static bool is_over(size_t i)
{
    char byte;
    return recv(theirs[i], &byte, 1, MSG_DONTWAIT) == 0;
}

static void test_the_oldest_makes_room(void)
{
    pairs_open();
    for (size_t i = 0; i < LOBBY_MAX; i++) {
        lobby_enter(&lobby, ours[i], i + 1);
    }
    lobby_enter(&lobby, ours[0], LOBBY_MAX + 1); /* it has ended a request: the next is oldest */
    CU_ASSERT_EQUAL(lobby.count, LOBBY_MAX);
    lobby_enter(&lobby, ours[LOBBY_MAX], LOBBY_MAX + 2);
    CU_ASSERT_EQUAL(lobby.count, LOBBY_MAX);
    CU_ASSERT_FALSE(is_over(0));
    CU_ASSERT(is_over(1));
    lobby_leave(&lobby, ours[2]);
    lobby_enter(&lobby, ours[LOBBY_MAX + 1], LOBBY_MAX + 3);
    for (size_t i = 2; i < PAIRS; i++) {
        CU_ASSERT_FALSE(is_over(i));
    }
    pairs_close();
}

static void test_nobody_waits_longer_than_ten_seconds(void)
{
    pairs_open();
    lobby_enter(&lobby, ours[0], 1000000000);
    lobby_enter(&lobby, ours[1], 3000000000);
    lobby_round(&lobby, 10900000000);
    CU_ASSERT_FALSE(is_over(0));
    lobby_round(&lobby, 11100000000);
    CU_ASSERT(is_over(0));
    CU_ASSERT_FALSE(is_over(1));
    CU_ASSERT_EQUAL(lobby.count, 1);
    lobby_leave(&lobby, ours[5]);
    CU_ASSERT_EQUAL(lobby.count, 1);
    pairs_close();
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"the oldest makes room", test_the_oldest_makes_room},
        {"nobody waits longer than ten seconds", test_nobody_waits_longer_than_ten_seconds},
        CU_TEST_INFO_NULL,
    };
    return suite_run("web/lobby", tests);
}
