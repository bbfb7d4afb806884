; SPDX-License-Identifier: Apache-2.0
;
; Wanders from the first step on and tells nobody: a thousand robots that each wrote to all others
; would measure the mail.

(deffunction tell-position (?x ?y))

(deffacts roam (goal safe-wander))
