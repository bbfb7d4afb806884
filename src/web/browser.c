/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Opens the page in the browser of the person who started the program.
 *
 * Other users see the words of a command line, so the address, which has the token in it, goes to
 * the browser in a file that only this user can read.
 */
#include "web/web.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

static char file[] = "/tmp/muster-page-XXXXXX.html";
static bool is_made;

/* @return whether there is a file now that leads to the page */
static bool file_make(const char *address)
{
    int fd = mkostemps(file, (int)sizeof ".html" - 1, O_CLOEXEC);
    is_made = fd >= 0;
    bool whole = fd >= 0 && dprintf(fd,
                                    "<!DOCTYPE html><meta charset=\"utf-8\"><title>muster</title>"
                                    "<meta http-equiv=\"refresh\" content=\"0;url=%s\">"
                                    "<a href=\"%s\">muster</a>\n",
                                    address, address) > 0;
    if (fd >= 0) {
        whole = close(fd) == 0 && whole;
    }
    return whole;
}

/* $BROWSER may have words of its own.  Without a screen, xdg-open would find a browser for the
 * terminal. */
static const char *command_find(void)
{
    const char *browser = getenv("BROWSER");
    const char *x = getenv("DISPLAY"), *wayland = getenv("WAYLAND_DISPLAY");
    if (browser && browser[0]) {
        return "exec $BROWSER \"$1\"";
    }
    return (x && x[0]) || (wayland && wayland[0]) ? "exec xdg-open \"$1\"" : NULL;
}

static void command_start(const char *command)
{
    pid_t child = fork();
    if (child == 0) {
        int nothing = open("/dev/null", O_RDWR);
        for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; fd++) {
            dup2(nothing, fd);
        }
        if (fork() == 0) { /* it outlives us, and is not ours to wait for */
            setsid();
            execl("/bin/sh", "sh", "-c", command, "sh", file, (char *)NULL);
        }
        _exit(0);
    }
    if (child > 0) {
        (void)waitpid(child, NULL, 0);
    }
}

void browser_open(const char *address)
{
    const char *command = command_find();
    if (!command) {
        fputs("muster web: no browser is known ($BROWSER, or xdg-open with a screen); open the "
              "address by hand\n",
              stderr);
        return;
    }
    if (file_make(address)) {
        command_start(command);
    } else {
        perror("muster web: cannot open a browser");
    }
}

void browser_close(void)
{
    if (is_made) {
        unlink(file);
    }
}
