" Colours of decks. Written from the program's tables: PERIGRAIN_BLESS=1 cargo test --test folders docs::
if exists('b:current_syntax')
  finish
endif
syntax case match
syntax match perigrainNumber /\v[[:alnum:]_.]@<![-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?[[:alnum:]_.]@!/
syntax match perigrainConstant /\v\S@<!(INF|EDGE|NULL|SELF|yes|no|on|off)\S@!/
syntax match perigrainReference /\v[[:alnum:]_.]@<![vcfCF]_\w+/
syntax match perigrainValue /\v\$\{[^}]*\}|\$\w|\$\([^)]*\)/
syntax match perigrainContinuation /&\s*$/
syntax match perigrainComment /#.*$/ contains=@Spell
syntax region perigrainString start=/"/ end=/"/ oneline contains=perigrainValue
syntax region perigrainString start=/'/ end=/'/ oneline contains=perigrainValue
syntax region perigrainString start=/"""/ end=/"""/ contains=perigrainValue
syntax match perigrainCommand /\v^\s*\zsangle_coeff\S@!/
syntax match perigrainCommand /\v^\s*\zsangle_style\S@!/
syntax match perigrainCommand /\v^\s*\zsatom_modify\S@!/
syntax match perigrainCommand /\v^\s*\zsatom_style\S@!/
syntax match perigrainCommand /\v^\s*\zsbalance\S@!/
syntax match perigrainCommand /\v^\s*\zsbond_coeff\S@!/
syntax match perigrainCommand /\v^\s*\zsbond_style\S@!/
syntax match perigrainCommand /\v^\s*\zsboundary\S@!/
syntax match perigrainCommand /\v^\s*\zscalibrate\S@!/
syntax match perigrainCommand /\v^\s*\zschange_box\S@!/
syntax match perigrainCommand /\v^\s*\zsclear\S@!/
syntax match perigrainCommand /\v^\s*\zsclump\S@!/
syntax match perigrainCommand /\v^\s*\zscomm_modify\S@!/
syntax match perigrainCommand /\v^\s*\zscomm_style\S@!/
syntax match perigrainCommand /\v^\s*\zscompat\S@!/
syntax match perigrainCommand /\v^\s*\zscompute\S@!/
syntax match perigrainCommand /\v^\s*\zscompute_modify\S@!/
syntax match perigrainCommand /\v^\s*\zscreate_atoms\S@!/
syntax match perigrainCommand /\v^\s*\zscreate_bonds\S@!/
syntax match perigrainCommand /\v^\s*\zscreate_box\S@!/
syntax match perigrainCommand /\v^\s*\zsdelete_atoms\S@!/
syntax match perigrainCommand /\v^\s*\zsdelete_bonds\S@!/
syntax match perigrainCommand /\v^\s*\zsdimension\S@!/
syntax match perigrainCommand /\v^\s*\zsdisplace_atoms\S@!/
syntax match perigrainCommand /\v^\s*\zsdump\S@!/
syntax match perigrainCommand /\v^\s*\zsdump_modify\S@!/
syntax match perigrainCommand /\v^\s*\zsecho\S@!/
syntax match perigrainCommand /\v^\s*\zsfatigue\S@!/
syntax match perigrainCommand /\v^\s*\zsfix\S@!/
syntax match perigrainCommand /\v^\s*\zsfix_modify\S@!/
syntax match perigrainCommand /\v^\s*\zsgroup\S@!/
syntax match perigrainFlow /\v^\s*\zsif\S@!/
syntax match perigrainFlow /\v^\s*\zsinclude\S@!/
syntax match perigrainCommand /\v^\s*\zsinfo\S@!/
syntax match perigrainFlow /\v^\s*\zsjump\S@!/
syntax match perigrainFlow /\v^\s*\zslabel\S@!/
syntax match perigrainCommand /\v^\s*\zslattice\S@!/
syntax match perigrainCommand /\v^\s*\zslog\S@!/
syntax match perigrainCommand /\v^\s*\zsmass\S@!/
syntax match perigrainCommand /\v^\s*\zsmaterial\S@!/
syntax match perigrainCommand /\v^\s*\zsmin_modify\S@!/
syntax match perigrainCommand /\v^\s*\zsmin_style\S@!/
syntax match perigrainCommand /\v^\s*\zsminimize\S@!/
syntax match perigrainCommand /\v^\s*\zsmixture\S@!/
syntax match perigrainCommand /\v^\s*\zsmolecule\S@!/
syntax match perigrainCommand /\v^\s*\zsneigh_modify\S@!/
syntax match perigrainCommand /\v^\s*\zsneighbor\S@!/
syntax match perigrainCommand /\v^\s*\zsnewton\S@!/
syntax match perigrainFlow /\v^\s*\zsnext\S@!/
syntax match perigrainCommand /\v^\s*\zspackage\S@!/
syntax match perigrainCommand /\v^\s*\zspair_coeff\S@!/
syntax match perigrainCommand /\v^\s*\zspair_modify\S@!/
syntax match perigrainCommand /\v^\s*\zspair_style\S@!/
syntax match perigrainCommand /\v^\s*\zspartition\S@!/
syntax match perigrainCommand /\v^\s*\zsperi_crack\S@!/
syntax match perigrainCommand /\v^\s*\zsperi_modify\S@!/
syntax match perigrainCommand /\v^\s*\zsprint\S@!/
syntax match perigrainCommand /\v^\s*\zsprocessors\S@!/
syntax match perigrainFlow /\v^\s*\zsquit\S@!/
syntax match perigrainCommand /\v^\s*\zsread_data\S@!/
syntax match perigrainCommand /\v^\s*\zsread_dump\S@!/
syntax match perigrainCommand /\v^\s*\zsread_mesh\S@!/
syntax match perigrainCommand /\v^\s*\zsread_points\S@!/
syntax match perigrainCommand /\v^\s*\zsread_restart\S@!/
syntax match perigrainCommand /\v^\s*\zsread_voxels\S@!/
syntax match perigrainCommand /\v^\s*\zsregion\S@!/
syntax match perigrainCommand /\v^\s*\zsreplicate\S@!/
syntax match perigrainCommand /\v^\s*\zsrerun\S@!/
syntax match perigrainCommand /\v^\s*\zsreset_atom_ids\S@!/
syntax match perigrainCommand /\v^\s*\zsreset_atoms\S@!/
syntax match perigrainCommand /\v^\s*\zsreset_mol_ids\S@!/
syntax match perigrainCommand /\v^\s*\zsreset_timestep\S@!/
syntax match perigrainCommand /\v^\s*\zsrestart\S@!/
syntax match perigrainCommand /\v^\s*\zsrun\S@!/
syntax match perigrainCommand /\v^\s*\zsrun_style\S@!/
syntax match perigrainCommand /\v^\s*\zsset\S@!/
syntax match perigrainCommand /\v^\s*\zsshell\S@!/
syntax match perigrainCommand /\v^\s*\zsspecial_bonds\S@!/
syntax match perigrainCommand /\v^\s*\zsstatics\S@!/
syntax match perigrainCommand /\v^\s*\zssuffix\S@!/
syntax match perigrainCommand /\v^\s*\zssweep\S@!/
syntax match perigrainCommand /\v^\s*\zsthermo\S@!/
syntax match perigrainCommand /\v^\s*\zsthermo_modify\S@!/
syntax match perigrainCommand /\v^\s*\zsthermo_style\S@!/
syntax match perigrainCommand /\v^\s*\zstimer\S@!/
syntax match perigrainCommand /\v^\s*\zstimestep\S@!/
syntax match perigrainCommand /\v^\s*\zsuncompute\S@!/
syntax match perigrainCommand /\v^\s*\zsundump\S@!/
syntax match perigrainCommand /\v^\s*\zsunfix\S@!/
syntax match perigrainCommand /\v^\s*\zsunits\S@!/
syntax match perigrainFlow /\v^\s*\zsvariable\S@!/
syntax match perigrainCommand /\v^\s*\zsvelocity\S@!/
syntax match perigrainCommand /\v^\s*\zswrite_data\S@!/
syntax match perigrainCommand /\v^\s*\zswrite_dump\S@!/
syntax match perigrainCommand /\v^\s*\zswrite_restart\S@!/
syntax match perigrainCommand /\v^\s*\zspair_style\S@!/ nextgroup=perigrain_pair_style_style skipwhite
syntax match perigrain_pair_style_style /\vbpm\/peri\S@!/ contained
syntax match perigrain_pair_style_style /\vbpm\/spring\S@!/ contained
syntax match perigrain_pair_style_style /\vgran\/hertz\/history\S@!/ contained
syntax match perigrain_pair_style_style /\vgran\/hooke\S@!/ contained
syntax match perigrain_pair_style_style /\vgran\/hooke\/history\S@!/ contained
syntax match perigrain_pair_style_style /\vgranular\S@!/ contained
syntax match perigrain_pair_style_style /\vhybrid\S@!/ contained
syntax match perigrain_pair_style_style /\vhybrid\/overlay\S@!/ contained
syntax match perigrain_pair_style_style /\vperi\/cauchy\S@!/ contained
syntax match perigrain_pair_style_style /\vperi\/eps\S@!/ contained
syntax match perigrain_pair_style_style /\vperi\/lps\S@!/ contained
syntax match perigrain_pair_style_style /\vperi\/pmb\S@!/ contained
syntax match perigrain_pair_style_style /\vperi\/pmb\/plastic\S@!/ contained
syntax match perigrain_pair_style_style /\vperi\/pmb\/softening\S@!/ contained
syntax match perigrain_pair_style_style /\vperi\/ves\S@!/ contained
syntax match perigrain_pair_style_style /\vsoft\S@!/ contained
syntax match perigrain_pair_style_style /\vzero\S@!/ contained
highlight default link perigrain_pair_style_style Type
syntax match perigrainCommand /\v^\s*\zsbond_style\S@!/ nextgroup=perigrain_bond_style_style skipwhite
syntax match perigrain_bond_style_style /\vbpm\/beam\S@!/ contained
syntax match perigrain_bond_style_style /\vbpm\/peri\S@!/ contained
syntax match perigrain_bond_style_style /\vbpm\/rotational\S@!/ contained
syntax match perigrain_bond_style_style /\vbpm\/spring\S@!/ contained
syntax match perigrain_bond_style_style /\vbpm\/spring\/plastic\S@!/ contained
syntax match perigrain_bond_style_style /\vharmonic\S@!/ contained
syntax match perigrain_bond_style_style /\vhybrid\S@!/ contained
syntax match perigrain_bond_style_style /\vzero\S@!/ contained
highlight default link perigrain_bond_style_style Type
syntax match perigrainCommand /\v^\s*\zsfix\S@!/ nextgroup=perigrain_fix_1 skipwhite
syntax match perigrain_fix_1 /\S\+/ contained nextgroup=perigrain_fix_2 skipwhite
syntax match perigrain_fix_2 /\S\+/ contained nextgroup=perigrain_fix_style skipwhite
syntax match perigrain_fix_style /\vadapt\S@!/ contained
syntax match perigrain_fix_style /\vaddforce\S@!/ contained
syntax match perigrain_fix_style /\vaddtorque\S@!/ contained
syntax match perigrain_fix_style /\vaddtorque\/atom\S@!/ contained
syntax match perigrain_fix_style /\vave\/atom\S@!/ contained
syntax match perigrain_fix_style /\vave\/chunk\S@!/ contained
syntax match perigrain_fix_style /\vave\/histo\S@!/ contained
syntax match perigrain_fix_style /\vave\/histo\/weight\S@!/ contained
syntax match perigrain_fix_style /\vave\/time\S@!/ contained
syntax match perigrain_fix_style /\vaveforce\S@!/ contained
syntax match perigrain_fix_style /\vbalance\S@!/ contained
syntax match perigrain_fix_style /\vbond\/break\S@!/ contained
syntax match perigrain_fix_style /\vbond\/create\S@!/ contained
syntax match perigrain_fix_style /\vcontroller\S@!/ contained
syntax match perigrain_fix_style /\vdamping\/cundall\S@!/ contained
syntax match perigrain_fix_style /\vdeform\S@!/ contained
syntax match perigrain_fix_style /\vdeform\/pressure\S@!/ contained
syntax match perigrain_fix_style /\vdeposit\S@!/ contained
syntax match perigrain_fix_style /\vdrag\S@!/ contained
syntax match perigrain_fix_style /\vdt\/critical\S@!/ contained
syntax match perigrain_fix_style /\vdt\/grain\S@!/ contained
syntax match perigrain_fix_style /\vdt\/guard\S@!/ contained
syntax match perigrain_fix_style /\vdt\/reset\S@!/ contained
syntax match perigrain_fix_style /\vefield\S@!/ contained
syntax match perigrain_fix_style /\venforce2d\S@!/ contained
syntax match perigrain_fix_style /\vevaporate\S@!/ contained
syntax match perigrain_fix_style /\vexternal\S@!/ contained
syntax match perigrain_fix_style /\vextremes\S@!/ contained
syntax match perigrain_fix_style /\vfreeze\S@!/ contained
syntax match perigrain_fix_style /\vgravity\S@!/ contained
syntax match perigrain_fix_style /\vhalt\S@!/ contained
syntax match perigrain_fix_style /\vheat\/convect\S@!/ contained
syntax match perigrain_fix_style /\vheat\/flow\S@!/ contained
syntax match perigrain_fix_style /\vheat\/flux\S@!/ contained
syntax match perigrain_fix_style /\vheat\/held\S@!/ contained
syntax match perigrain_fix_style /\vheat\/peri\S@!/ contained
syntax match perigrain_fix_style /\vindent\S@!/ contained
syntax match perigrain_fix_style /\vinsert\S@!/ contained
syntax match perigrain_fix_style /\vlangevin\S@!/ contained
syntax match perigrain_fix_style /\vlineforce\S@!/ contained
syntax match perigrain_fix_style /\vmassflow\/mesh\S@!/ contained
syntax match perigrain_fix_style /\vmomentum\S@!/ contained
syntax match perigrain_fix_style /\vmove\S@!/ contained
syntax match perigrain_fix_style /\vmove\/mesh\S@!/ contained
syntax match perigrain_fix_style /\vnve\S@!/ contained
syntax match perigrain_fix_style /\vnve\/bpm\/sphere\S@!/ contained
syntax match perigrain_fix_style /\vnve\/limit\S@!/ contained
syntax match perigrain_fix_style /\vnve\/noforce\S@!/ contained
syntax match perigrain_fix_style /\vnve\/sphere\S@!/ contained
syntax match perigrain_fix_style /\vperi\/strength\S@!/ contained
syntax match perigrain_fix_style /\vplaneforce\S@!/ contained
syntax match perigrain_fix_style /\vpour\S@!/ contained
syntax match perigrain_fix_style /\vprint\S@!/ contained
syntax match perigrain_fix_style /\vproperty\/atom\S@!/ contained
syntax match perigrain_fix_style /\vpython\/invoke\S@!/ contained
syntax match perigrain_fix_style /\vrecenter\S@!/ contained
syntax match perigrain_fix_style /\vrigid\S@!/ contained
syntax match perigrain_fix_style /\vrigid\/nve\S@!/ contained
syntax match perigrain_fix_style /\vrigid\/nve\/small\S@!/ contained
syntax match perigrain_fix_style /\vrigid\/small\S@!/ contained
syntax match perigrain_fix_style /\vsetforce\S@!/ contained
syntax match perigrain_fix_style /\vsettorque\/atom\S@!/ contained
syntax match perigrain_fix_style /\vspring\S@!/ contained
syntax match perigrain_fix_style /\vspring\/self\S@!/ contained
syntax match perigrain_fix_style /\vstore\/force\S@!/ contained
syntax match perigrain_fix_style /\vstore\/state\S@!/ contained
syntax match perigrain_fix_style /\vsurface\S@!/ contained
syntax match perigrain_fix_style /\vvector\S@!/ contained
syntax match perigrain_fix_style /\vviscous\S@!/ contained
syntax match perigrain_fix_style /\vviscous\/nonlinear\S@!/ contained
syntax match perigrain_fix_style /\vviscous\/sphere\S@!/ contained
syntax match perigrain_fix_style /\vwall\/colloid\S@!/ contained
syntax match perigrain_fix_style /\vwall\/gran\S@!/ contained
syntax match perigrain_fix_style /\vwall\/gran\/region\S@!/ contained
syntax match perigrain_fix_style /\vwall\/harmonic\S@!/ contained
syntax match perigrain_fix_style /\vwall\/lj1043\S@!/ contained
syntax match perigrain_fix_style /\vwall\/lj126\S@!/ contained
syntax match perigrain_fix_style /\vwall\/lj93\S@!/ contained
syntax match perigrain_fix_style /\vwall\/mesh\S@!/ contained
syntax match perigrain_fix_style /\vwall\/morse\S@!/ contained
syntax match perigrain_fix_style /\vwall\/reflect\S@!/ contained
syntax match perigrain_fix_style /\vwall\/region\S@!/ contained
highlight default link perigrain_fix_style Type
syntax match perigrainCommand /\v^\s*\zscompute\S@!/ nextgroup=perigrain_compute_1 skipwhite
syntax match perigrain_compute_1 /\S\+/ contained nextgroup=perigrain_compute_2 skipwhite
syntax match perigrain_compute_2 /\S\+/ contained nextgroup=perigrain_compute_style skipwhite
syntax match perigrain_compute_style /\vaggregate\/atom\S@!/ contained
syntax match perigrain_compute_style /\vangmom\/chunk\S@!/ contained
syntax match perigrain_compute_style /\vbond\/local\S@!/ contained
syntax match perigrain_compute_style /\vcentro\/atom\S@!/ contained
syntax match perigrain_compute_style /\vchunk\/atom\S@!/ contained
syntax match perigrain_compute_style /\vchunk\/spread\/atom\S@!/ contained
syntax match perigrain_compute_style /\vcluster\/atom\S@!/ contained
syntax match perigrain_compute_style /\vcom\S@!/ contained
syntax match perigrain_compute_style /\vcom\/chunk\S@!/ contained
syntax match perigrain_compute_style /\vcontact\/atom\S@!/ contained
syntax match perigrain_compute_style /\vcontinuum\/chunk\S@!/ contained
syntax match perigrain_compute_style /\vcoord\/atom\S@!/ contained
syntax match perigrain_compute_style /\vcount\/type\S@!/ contained
syntax match perigrain_compute_style /\vcrack\S@!/ contained
syntax match perigrain_compute_style /\vdamage\/atom\S@!/ contained
syntax match perigrain_compute_style /\vdilatation\/atom\S@!/ contained
syntax match perigrain_compute_style /\vdisplace\/atom\S@!/ contained
syntax match perigrain_compute_style /\vdt\/critical\S@!/ contained
syntax match perigrain_compute_style /\venergy\/ledger\S@!/ contained
syntax match perigrain_compute_style /\verotate\/rigid\S@!/ contained
syntax match perigrain_compute_style /\verotate\/sphere\S@!/ contained
syntax match perigrain_compute_style /\verotate\/sphere\/atom\S@!/ contained
syntax match perigrain_compute_style /\vfabric\S@!/ contained
syntax match perigrain_compute_style /\vfragment\/atom\S@!/ contained
syntax match perigrain_compute_style /\vfragments\S@!/ contained
syntax match perigrain_compute_style /\vglobal\/atom\S@!/ contained
syntax match perigrain_compute_style /\vgroup\/group\S@!/ contained
syntax match perigrain_compute_style /\vgyration\S@!/ contained
syntax match perigrain_compute_style /\vgyration\/chunk\S@!/ contained
syntax match perigrain_compute_style /\vinertia\/chunk\S@!/ contained
syntax match perigrain_compute_style /\vke\S@!/ contained
syntax match perigrain_compute_style /\vke\/atom\S@!/ contained
syntax match perigrain_compute_style /\vke\/rigid\S@!/ contained
syntax match perigrain_compute_style /\vmomentum\S@!/ contained
syntax match perigrain_compute_style /\vmsd\S@!/ contained
syntax match perigrain_compute_style /\vmsd\/chunk\S@!/ contained
syntax match perigrain_compute_style /\vnbond\/atom\S@!/ contained
syntax match perigrain_compute_style /\vomega\/chunk\S@!/ contained
syntax match perigrain_compute_style /\vpair\S@!/ contained
syntax match perigrain_compute_style /\vpair\/local\S@!/ contained
syntax match perigrain_compute_style /\vpe\S@!/ contained
syntax match perigrain_compute_style /\vpe\/atom\S@!/ contained
syntax match perigrain_compute_style /\vperi\/defgrad\/atom\S@!/ contained
syntax match perigrain_compute_style /\vperi\/energy\/atom\S@!/ contained
syntax match perigrain_compute_style /\vperi\/state\/atom\S@!/ contained
syntax match perigrain_compute_style /\vperi\/strain\/atom\S@!/ contained
syntax match perigrain_compute_style /\vperi\/stress\/atom\S@!/ contained
syntax match perigrain_compute_style /\vplasticity\/atom\S@!/ contained
syntax match perigrain_compute_style /\vpressure\S@!/ contained
syntax match perigrain_compute_style /\vproperty\/atom\S@!/ contained
syntax match perigrain_compute_style /\vproperty\/chunk\S@!/ contained
syntax match perigrain_compute_style /\vproperty\/local\S@!/ contained
syntax match perigrain_compute_style /\vrdf\S@!/ contained
syntax match perigrain_compute_style /\vreduce\S@!/ contained
syntax match perigrain_compute_style /\vreduce\/chunk\S@!/ contained
syntax match perigrain_compute_style /\vreduce\/region\S@!/ contained
syntax match perigrain_compute_style /\vrigid\/local\S@!/ contained
syntax match perigrain_compute_style /\vslice\S@!/ contained
syntax match perigrain_compute_style /\vstatics\S@!/ contained
syntax match perigrain_compute_style /\vstress\/atom\S@!/ contained
syntax match perigrain_compute_style /\vtemp\S@!/ contained
syntax match perigrain_compute_style /\vtemp\/chunk\S@!/ contained
syntax match perigrain_compute_style /\vtemp\/com\S@!/ contained
syntax match perigrain_compute_style /\vtemp\/deform\S@!/ contained
syntax match perigrain_compute_style /\vtemp\/partial\S@!/ contained
syntax match perigrain_compute_style /\vtemp\/profile\S@!/ contained
syntax match perigrain_compute_style /\vtemp\/ramp\S@!/ contained
syntax match perigrain_compute_style /\vtemp\/region\S@!/ contained
syntax match perigrain_compute_style /\vtemp\/sphere\S@!/ contained
syntax match perigrain_compute_style /\vtorque\/chunk\S@!/ contained
syntax match perigrain_compute_style /\vvacf\S@!/ contained
syntax match perigrain_compute_style /\vvacf\/chunk\S@!/ contained
syntax match perigrain_compute_style /\vvcm\/chunk\S@!/ contained
syntax match perigrain_compute_style /\vwall\/local\S@!/ contained
highlight default link perigrain_compute_style Type
syntax match perigrainCommand /\v^\s*\zsdump\S@!/ nextgroup=perigrain_dump_1 skipwhite
syntax match perigrain_dump_1 /\S\+/ contained nextgroup=perigrain_dump_2 skipwhite
syntax match perigrain_dump_2 /\S\+/ contained nextgroup=perigrain_dump_style skipwhite
syntax match perigrain_dump_style /\vatom\S@!/ contained
syntax match perigrain_dump_style /\vatom\/gz\S@!/ contained
syntax match perigrain_dump_style /\vcfg\S@!/ contained
syntax match perigrain_dump_style /\vcfg\/gz\S@!/ contained
syntax match perigrain_dump_style /\vcustom\S@!/ contained
syntax match perigrain_dump_style /\vcustom\/gz\S@!/ contained
syntax match perigrain_dump_style /\vimage\S@!/ contained
syntax match perigrain_dump_style /\vlocal\S@!/ contained
syntax match perigrain_dump_style /\vlocal\/gz\S@!/ contained
syntax match perigrain_dump_style /\vmesh\/stl\S@!/ contained
syntax match perigrain_dump_style /\vmesh\/vtk\S@!/ contained
syntax match perigrain_dump_style /\vmovie\S@!/ contained
syntax match perigrain_dump_style /\vvtk\S@!/ contained
syntax match perigrain_dump_style /\vxyz\S@!/ contained
syntax match perigrain_dump_style /\vxyz\/gz\S@!/ contained
syntax match perigrain_dump_style /\vyaml\S@!/ contained
highlight default link perigrain_dump_style Type
highlight default link perigrainCommand Function
highlight default link perigrainFlow Keyword
highlight default link perigrainNumber Number
highlight default link perigrainConstant Constant
highlight default link perigrainReference Identifier
highlight default link perigrainValue Identifier
highlight default link perigrainContinuation Special
highlight default link perigrainComment Comment
highlight default link perigrainString String
let b:current_syntax = 'perigrain'
