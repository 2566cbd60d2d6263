# Takes the first C++ block out of the README into OUT, so that it is compiled as it stands.
file(READ ${README} text)
string(FIND "${text}" "```cpp\n" start)
string(SUBSTRING "${text}" ${start} -1 text)
string(SUBSTRING "${text}" 7 -1 text)
string(FIND "${text}" "\n```" end)
string(SUBSTRING "${text}" 0 ${end} text)
file(WRITE ${OUT} "${text}\n")
