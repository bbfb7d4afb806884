; SPDX-License-Identifier: Apache-2.0
;
; What every robot answers whoever asks: (ask-one red status), (ask-all robots goal).  A question of
; one word is answered by the deffunction answer-WORD, in any state and before rules fire; a rule
; file adds others, or says these in another way.  FALSE leaves the question to rules.

(deffunction answer-status ()
  "status NAME, then the seven fields of (position)"
  (create$ status ?*my-name* (position)))

(deffunction answer-goal ()
  "goal follow, or goal none"
  (bind ?goals (findall (goal $?)))
  (if (= 0 (length$ ?goals)) then
    (return (create$ goal none)))
  (create$ goal (fact-fields (nth$ 1 ?goals))))
