/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/terminal/terminal.h"

#include "core/text.h"

#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

enum { SCREEN_BYTES = 256 * 1024, TYPED_MAX = 64, WIDE_USUAL = 80, HIGH_USUAL = 24 };

static struct {
    bool taken, colors;
    struct termios before;
    size_t wide, high;
    size_t lines;
    char bytes[SCREEN_BYTES];
    struct mu_text text;
    char typed[TYPED_MAX];
    size_t typed_len;
} screen;

/* A terminal that has gone cannot be told: the next read says so. */
static void screen_write(const char *bytes, size_t len)
{
    while (len > 0) {
        ssize_t written = write(STDOUT_FILENO, bytes, len);
        if (written <= 0) {
            return;
        }
        bytes += written;
        len -= (size_t)written;
    }
}

bool top_screen_open(void)
{
    const char *term = getenv("TERM"), *plain = getenv("NO_COLOR");
    if (!isatty(STDIN_FILENO) || !isatty(STDOUT_FILENO) || !term || strcmp(term, "dumb") == 0 ||
        tcgetattr(STDIN_FILENO, &screen.before) != 0) {
        return false;
    }
    struct termios raw = screen.before;
    raw.c_lflag &= ~(tcflag_t)(ICANON | ECHO);
    raw.c_cc[VMIN] = 0;
    raw.c_cc[VTIME] = 0;
    screen.colors = !plain || !plain[0];
    screen.taken = tcsetattr(STDIN_FILENO, TCSANOW, &raw) == 0;
    static const char enter[] = "\x1b[?1049h\x1b[?25l";
    screen_write(enter, sizeof enter - 1);
    return screen.taken;
}

void top_screen_close(void)
{
    if (!screen.taken) {
        return;
    }
    static const char leave[] = "\x1b[?25h\x1b[?1049l";
    screen_write(leave, sizeof leave - 1);
    (void)tcsetattr(STDIN_FILENO, TCSANOW, &screen.before);
    screen.taken = false;
}

void top_screen_size(size_t *wide, size_t *high)
{
    struct winsize size;
    bool known = ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col && size.ws_row;
    *wide = known ? size.ws_col : WIDE_USUAL;
    *high = known ? size.ws_row : HIGH_USUAL;
}

void top_screen_begin(void)
{
    top_screen_size(&screen.wide, &screen.high);
    mu_text_init(&screen.text, screen.bytes, sizeof screen.bytes);
    mu_text_add(&screen.text, "\x1b[H");
    screen.lines = 0;
}

/* "15;0", of many terminals: colours of letters and of the ground. */
static bool is_light(void)
{
    const char *says = getenv("COLORFGBG"), *ground = says ? strrchr(says, ';') : NULL;
    return ground && (strcmp(ground, ";7") == 0 || strcmp(ground, ";15") == 0);
}

void top_screen_robot(const char *text, const struct palette_color *color)
{
    unsigned rgb[3];
    size_t len = strnlen(text, screen.wide), name = strcspn(text, " ");
    const char *hex = is_light() ? color->light : color->dark;
    if (!screen.colors || name > len || sscanf(hex, "#%2x%2x%2x", &rgb[0], &rgb[1], &rgb[2]) != 3) {
        top_screen_line(text, false);
        return;
    }
    if (screen.lines >= screen.high) {
        return;
    }
    mu_text_add(&screen.text, screen.lines++ ? "\r\n" : "");
    mu_text_format(&screen.text, "\x1b[38;2;%u;%u;%um", rgb[0], rgb[1], rgb[2]);
    mu_text_add_bytes(&screen.text, text, name);
    mu_text_add(&screen.text, "\x1b[0m");
    mu_text_add_bytes(&screen.text, text + name, len - name);
    mu_text_add(&screen.text, "\x1b[K");
}

/* Each line clears what stood behind it: nothing flickers. */
void top_screen_line(const char *text, bool lit)
{
    if (screen.lines >= screen.high) {
        return;
    }
    size_t len = strnlen(text, screen.wide);
    mu_text_add(&screen.text, screen.lines++ ? "\r\n" : "");
    mu_text_add(&screen.text, lit && screen.colors ? "\x1b[7m" : "");
    mu_text_add_bytes(&screen.text, text, len);
    mu_text_add(&screen.text, lit && screen.colors ? "\x1b[0m\x1b[K" : "\x1b[K");
}

void top_screen_show(void)
{
    mu_text_add(&screen.text, "\x1b[J");
    screen_write(screen.text.at, screen.text.len);
}

/* --- keys ------------------------------------------------------------------------------------- */

static const struct {
    const char *bytes;
    enum top_key key;
} keys[] = {
    {"\x1b[A", TOP_KEY_UP},
    {"\x1bOA", TOP_KEY_UP},
    {"\x1b[B", TOP_KEY_DOWN},
    {"\x1bOB", TOP_KEY_DOWN},
    {"\x1b[5~", TOP_KEY_PAGE_UP},
    {"\x1b[6~", TOP_KEY_PAGE_DOWN},
    {"q", TOP_KEY_QUIT},
    {"Q", TOP_KEY_QUIT},
    {"s", TOP_KEY_SORT},
    {"S", TOP_KEY_SORT_BACK},
    {"k", TOP_KEY_UP},
    {"j", TOP_KEY_DOWN},
    {" ", TOP_KEY_PAGE_DOWN},
};

/* A closed terminal ends the program. */
static void typed_read(void)
{
    struct pollfd in = {.fd = STDIN_FILENO, .events = POLLIN};
    if (poll(&in, 1, 0) <= 0) {
        return;
    }
    ssize_t got = read(STDIN_FILENO, screen.typed + screen.typed_len, TYPED_MAX - screen.typed_len);
    if (got > 0) {
        screen.typed_len += (size_t)got;
    } else if (screen.typed_len < TYPED_MAX) {
        screen.typed[screen.typed_len++] = 'q';
    }
}

static void typed_drop(size_t len)
{
    screen.typed_len -= len;
    memmove(screen.typed, screen.typed + len, screen.typed_len);
}

enum top_key top_screen_key(void)
{
    if (screen.typed_len == 0) {
        typed_read();
    }
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        size_t len = strlen(keys[i].bytes);
        if (screen.typed_len >= len && memcmp(screen.typed, keys[i].bytes, len) == 0) {
            typed_drop(len);
            return keys[i].key;
        }
    }
    typed_drop(screen.typed_len > 0);
    return TOP_KEY_NONE;
}
