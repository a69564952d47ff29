# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The verdicts on a printed number or equation, and what each means; the help lists them."""
VERDICTS = {
    'agrees': 'to the last printed digit',
    'read off a drawing': 'as near as a drawing can be read',
    'rounded on the way': 'computed from rounded numbers',
    'copy garbled': 'our copy of the document garbles it: what is shown is a reading of the copy, '
                    'or a doubt',
    'misprint': 'a slip in print; the reason is given, and for equations the correction was '
                'checked',
    'wrong computation': 'the document computed something else; the reason is given',
    'assumption of ours': 'not printed; what we took for it',
    'definition': 'of symbols, or a step that a numbered equation sums up',
    'answered here': 'the document asks; what must hold for the answer was computed',
    'not compared': 'and why',
    'DIFFERS': 'without a known reason',
}
(AGREES, DRAWN, ROUNDED, GARBLED, MISPRINT, WRONG, ASSUMED, DEFINED, ANSWERED, MISSING,
 DIFFERS) = VERDICTS
