# SPDX-License-Identifier: Apache-2.0
"""Groups and the yellow pages between processes that come, go and are killed."""
from support import (Processes, broker_start, check, check_equal, folder, members, muster,
                     new_domain, program, wait_for, whole_lines)


def agent_start(processes, domain, name, out, *attributes):
    return processes.start(program("pages_agent"), domain, name, out / name, *attributes)


def heard(out, name, line, count=1):
    wait_for(lambda: whole_lines(out / name).count(line) >= count, 10, f"{name} to hear: {line}")


def test_a_service_is_found_and_goes_with_its_agent():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker_start(processes, domain)
        agent_start(processes, domain, "seeker", out)
        heard(out, "seeker", "members seeker")
        mapper = agent_start(processes, domain, "mapper1", out, "role=scout x=3 y=4")
        agent_start(processes, domain, "mapper2", out, "role=scout x=3 y=4.1")
        heard(out, "seeker", "came mapper mapper1 [role=scout x=3 y=4] found some")
        heard(out, "seeker", "members mapper1 mapper2 seeker")
        mapper.kill()
        mapper.wait()
        heard(out, "seeker", "went mapper mapper1 [role=scout x=3 y=4] found some")
        check(not any("mapper2 [" in line for line in whole_lines(out / "seeker")), "mapper2 is too far")
        agent_start(processes, domain, "mapper1", out, "role=scout x=3 y=4")
        heard(out, "seeker", "came mapper mapper1 [role=scout x=3 y=4] found some", 2)


def test_group_mail_waits_for_an_absent_member():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker_start(processes, domain)
        seeker = agent_start(processes, domain, "seeker", out)
        agent_start(processes, domain, "mapper", out, "role=scout")
        heard(out, "mapper", "members mapper seeker")
        seeker.terminate()
        seeker.wait()
        wait_for(lambda: members(domain)["seeker"]["state"] == "absent", 10, "its absence")
        check_equal(muster("send", "mapper", "gold", "--domain", domain).returncode, 0, "mail")
        heard(out, "mapper", "mail operator gold")
        before = len(whole_lines(out / "seeker"))
        agent_start(processes, domain, "seeker", out)
        heard(out, "seeker", "mail mapper gold")
        check("members mapper seeker" in whole_lines(out / "seeker")[before:], "it is a member still")
        check("mail mapper gold" not in whole_lines(out / "mapper"), "no member gets its own mail")


def test_what_the_broker_refuses_is_told():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker_start(processes, domain)
        agent_start(processes, domain, "seeker", out)
        heard(out, "seeker", "members seeker")
        check_equal(muster("send", "seeker", "create", "--domain", domain).returncode, 0, "mail")
        heard(out, "seeker", "refused group-create scouts group-exists")
        done = muster("send", "group:scouts", "hello", "--domain", domain)
        check_equal((done.returncode, done.stdout.strip()), (0, "delivered"), "mail to the group")
        heard(out, "seeker", "mail operator hello")
        for nobody in ("group:nobody", "role:nobody"):
            done = muster("send", nobody, "hello", "--domain", domain)
            check_equal(done.returncode, 7, f"mail to {nobody}: {done.stderr}")
        mails = [line for line in whole_lines(out / "seeker") if line.startswith("mail broker")]
        check_equal(mails, [], "answers to changes that reached on_mail")
