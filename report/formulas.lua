-- pandoc -f formulas.lua -t html SOURCES: a C++ table of every R"tex(...)tex" in the sources, each with its MathML.
function Reader(sources)
  local out = {}
  for tex in tostring(sources):gmatch('R"tex%((.-)%)tex"') do
    local upright = tex:gsub('\\mathrm(%b{})', '\\text%1')    -- browsers ignore mathvariant on more than one letter
    local one = pandoc.Pandoc({pandoc.Plain{pandoc.Math('DisplayMath', upright)}})
    local html = pandoc.write(one, 'html', {html_math_method = 'mathml'})
    html = html:gsub('<m[io]>⊤</m[io]>', '<mi mathvariant="normal">T</mi>')    -- fonts without ⊤ raise it too high
    if not tex:find('\\left', 1, true) then    -- plain parentheses are as high as a letter, but for those of a matrix
      html = html:gsub('stretchy="true"( form="prefix">%(</mo><mtable)', '%1'):gsub('(</mtable><mo )stretchy="true" ', '%1')
      html = html:gsub('stretchy="true"( form="%w+">[()])', 'stretchy="false"%1')
    end
    if html:find('<math', 1, true) then    -- pandoc says which it does not understand
      out[#out + 1] = '{R"tex(' .. tex .. ')tex",\nR"mathml(' .. html .. ')mathml"},\n'
    end
  end
  return pandoc.Pandoc{pandoc.RawBlock('html', table.concat(out))}
end
