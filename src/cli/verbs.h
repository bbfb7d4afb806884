/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file verbs.h
 * The verbs of the command `muster`: one function each, with argv[0] the verb's own name.
 *
 * @return each: the exit code
 */
#ifndef MUSTER_CLI_VERBS_H
#define MUSTER_CLI_VERBS_H

int run_verb(int argc, char **argv);
int report_verb(int argc, char **argv);
int compare_verb(int argc, char **argv);

int pages_verb_ps(int argc, char **argv);
int pages_verb_lookup(int argc, char **argv);

int wait_verb(int argc, char **argv);

int post_verb(int argc, char **argv); /* of all that send mail: "send", "group send", ... */

int console_verb(int argc, char **argv);

int group_verb(int argc, char **argv);
int service_verb(int argc, char **argv);

int launch_verb(int argc, char **argv);

int verify_verb(int argc, char **argv);
int why_verb(int argc, char **argv);

int world_verb(int argc, char **argv);

int top_verb(int argc, char **argv);

#endif
