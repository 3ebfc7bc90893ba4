" Made by editors/grammar.py.
if exists('b:current_syntax')
  finish
endif
syntax case ignore
syntax keyword yarcOption STRETCH ALLOW BLEND UNTIL INTO NEAR ACC TOL VEL
syntax keyword yarcOperator AND NOT OR
syntax keyword yarcFunction ATAN2 FLOOR CEIL SQRT ABS COS MAX MIN SIN TAN
syntax keyword yarcConstant OFF ON PI V
syntax match yarcNumber /\v<\d+%(\.\d*)?%(e[+-]?\d+)?>/
syntax match yarcVariable /\v\$[A-Za-z_][A-Za-z0-9_.]*/
syntax match yarcUnit /\v\$@<!\(\s*%(deg|min|rad|cm|in|mm|ms|um|m|s)\s*%(,\s*%(deg|min|rad|cm|in|mm|ms|um|m|s)\s*)*\)/
syntax match yarcCommand /\v%([A-Za-z0-9_.$])@<!%(MOVEJ_SPLINE|MOVEL_SPLINE|MOVEJ_TIMED|MOVJ_SPLINE|DMOVEJ|RETURN|ABORT|DMOVE|DMOVJ|MOVEC|MOVEJ|MOVEL|PULSE|CALL|DMOV|EXIT|HOLD|JPOS|LPOS|MOVJ|MOVL|STOP|TOOL|WAIT|SAY|SET)%(_%(SCURVE|AVOID|POLY5|LSPB|QUAT|TOPP|RPY))*%([A-Za-z0-9_.])@!/
syntax match yarcIndex /\v^\s*P\d+>/
syntax match yarcBlock /\v^\s*%(OFFSET|REPEAT|UNTIL|WHILE|CASE|ELSE|KEEP|LOOP|WHEN|END|SUB|IF|OF)%([A-Za-z0-9_.])@!/
syntax match yarcDeclaration /\v^\s*%(FRAME_QUAT|REGISTER|DEFAULT|JOINTS|OUTPUT|FRAME|INPUT|ROBOT|START|TABLE|CELL|FUNC|POSE|LET|USE|ON)%([A-Za-z0-9_.])@!/
syntax match yarcForeign /[^\t -~]/
syntax match yarcFrame /{[^{}!"]*}/
syntax match yarcString /"[^"]*"\=/
syntax match yarcComment /!.*$/ contains=@Spell
highlight default link yarcBlock Conditional
highlight default link yarcCommand Function
highlight default link yarcComment Comment
highlight default link yarcConstant Constant
highlight default link yarcDeclaration StorageClass
highlight default link yarcForeign Error
highlight default link yarcFrame Identifier
highlight default link yarcFunction Function
highlight default link yarcIndex Label
highlight default link yarcNumber Number
highlight default link yarcOperator Operator
highlight default link yarcOption Keyword
highlight default link yarcString String
highlight default link yarcUnit Type
highlight default link yarcVariable Identifier
let b:current_syntax = 'yarc'
