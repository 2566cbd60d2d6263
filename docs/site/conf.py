# Sphinx reads this; build.py runs it. Nothing here is fetched from anywhere.
import os
import re
import sys
from pathlib import Path

here = Path(os.environ["RLSLAB_SITE"])
sys.path.insert(0, str(here))
project = "rlslab"
author = "the rlslab authors"
version = release = re.search(r"project\([^)]*VERSION ([\d.]+)", (here.parents[1] / "CMakeLists.txt").read_text())[1]
extensions = ["myst_parser", "sphinx_tabs.tabs", "sphinx.ext.napoleon", "mathml"]
myst_enable_extensions = ["dollarmath", "amsmath"]
myst_all_links_external = True    # build.py has resolved them
myst_dmath_double_inline = True
suppress_warnings = ["myst.header"]    # pages whose parts begin at the third level
sphinx_tabs_disable_tab_closing = True
napoleon_use_rtype = False
highlight_language = "none"
html_math_renderer = "pandoc"
html_theme = "furo"
html_title = f"rlslab {version}"
html_static_path = [str(here / "static")]
html_css_files, html_js_files = ["site.css"], ["site.js"]
html_show_search_summary = False    # which would read pages by requests; from a folder there are none
html_copy_source = html_show_sphinx = html_show_copyright = False
html_use_index = False
pygments_style, pygments_dark_style = "xcode", "github-dark"
fonts = "system-ui,-apple-system,'Segoe UI',Helvetica,Arial,sans-serif"
html_theme_options = {"light_css_variables": {"font-stack": fonts}, "top_of_page_button": None}
