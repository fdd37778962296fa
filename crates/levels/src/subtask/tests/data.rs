//! Task data for tests of Subtask and Task: a tray of the MBD, a vise, a nest, the pedestal, the drum, three
//! holsters, and an object for each gripper.

use std::sync::OnceLock;

use taskdata::{
    files::TaskData,
    load::{Source, Store},
};

const TEXT: &str = "BLOCK# 1 OFFSET 21000
    0    -5022      636
    0    -7145    -1483
 3000    -7145    -1483   -pose-   ...         HOME-POS
-6650     -550     1600
-6650     -550    -1400
-6650    -3550    -1400   -pose-   ...         UT-1-P
 3800    -4400     -400
 6800    -4400     -400
 6800    -1400     -400   -pose-   ...         PFIX-P
 1972    -3708    -1000
 3380    -6357    -1000
 6029    -4949    -1000   -pose-   ...         PED-P
 1972    -3708     1000
 3380    -6357     1000
 6029    -4949     1000   -pose-   ...         PED-SAFE-P
BLOCK# 2 OFFSET 21000
-1188    -3176     -407
-1261    -3372    -3400
 1549    -4423    -3400   -pose-   ...         HOL-R-P
 1867    -4194     -407
 1952    -4385    -3400
 4693    -3165    -3400   -pose-   ...         HOL-C-P
 2598    -2179     -407
 2758    -2314    -3400
 4686      -16    -3400   -pose-   ...         HOL-L-P
 5298    -2322     1559
 8296    -2431     1585
 8357    -1417    -1238   -pose-   ...         TOOL-SAF-P
 6497    -2366     1569
 9495    -2475     1595
 9507    -1459    -1228   -pose-   ...         TOOL-TR-P
BLOCK# 3 OFFSET 21000
ERASE-MOVTAB
    1    t      255     -525   -525      -mtb-   SCT-MTB
    1    t        0    -1050      0      -mtb-   -1050ty
BLOCK# 4 OFFSET 21000
 -arr-  SECTORS        1    2     -1050ty                0
  -ar-   SECTORS        ...           SCT-MTB
  -pt-  HOME         HOME-POS     ...
  -pt-  SAFE         HOME-POS     ...
  -pt-  UNIT_1       UT-1-P       ...
  -pt-  PFIXTURE     PFIX-P       ...
  -pt-  V-VFIXTURE   PFIX-P       ...
  -pt-  PEDESTAL     PED-P        ...
  -pt-  PED-SAFE     PED-SAFE-P   ...
  -pt-  HOLSTER-R    HOL-R-P      ...
  -pt-  HOLSTER-C    HOL-C-P      ...
  -pt-  HOLSTER-L    HOL-L-P      ...
  -pt-  TOOL-SAFE    TOOL-SAF-P   ...
  -pt-  TOOL-TRNS    TOOL-TR-P    ...
BLOCK# 5 OFFSET 21000
  -own-  UNIT           -m-   lpt        UNIT_1
  -own-  VFIXTURE       -m-   lpt        V-VFIXTURE
  -own-  UNIT_1         -m-   lpt        UNIT_1
                        -m-   arr        SECTORS
  -own-  HOLSTER        -m-   lpt        HOLSTER-R
                        -m-   lpt        HOLSTER-L
                        -m-   lpt        HOLSTER-C
BLOCK# 6 OFFSET 21000
-traj   UT1-PFIX       lpt     UNIT_1  lpt    PFIXTURE
  -ppt     4      100      8      300     mtb    -1050ty
-traj   TRNS-TOOLS     lpt     TOOL-TRNS  lpt    TOOL-SAFE
BLOCK# 1 OFFSET 20000
  -obj-  PART             1     300     60     30     350
  -obj-  PART            -1     310     61     31     351
  -obj-  PART             2     320     62     32     352
  -obj-  BAR              1     300     60     30     350
  -obj-  BAR              2     300     60     30     350
  -obj-  CYLINDER         1     300    200     30     350
  -obj-  TOOL-1           1     400    200     30     400
  -obj-  GRIPPER-1        1      50     10      0      50
  -obj-  GRIPPER-1        2       0      0      0       0
  -obj-  GRIPPER-2        1      50     10      0      50
  -obj-  GRIPPER-2        2       0      0      0       0
  -obj-  GRIPPER-3        1      50     10      0      50
BLOCK# 2 OFFSET 20000
FDEF
:S \"object\" <= PART
   endeff-id# <= 1
   tray-grip# <= 1
:R >FILE OBJ-GRIPS
:S \"object\" <= BAR
   endeff-id# <= 1
   tray-grip# <= 1
:R >FILE OBJ-GRIPS
:S \"object\" <= CYLINDER
   endeff-id# <= 2
   tray-grip# <= 1
:R >FILE OBJ-GRIPS
BLOCK# 3 OFFSET 20000
FDEF
:S \"object\" <= TOOL-1
   endeff-id# <= 3
   tray-grip# <= 1
:R >FILE OBJ-GRIPS
:S \"p-object\" <= PART
   ped-appr <= 500
   ped-grasp-size <= 250
   ped-force <= 50
   ped-release-size <= 450
   ped-table-pos <= -2135
   ped-flip-angle <= 1835
:R >FILE PED-PARA
BLOCK# 4 OFFSET 20000
 -o-loc- PART        arr SECTORS
 -o-loc- BAR         arr SECTORS
 -o-loc- CYLINDER    arr SECTORS
 -o-loc- TOOL-1      arr SECTORS
 -o-loc- GRIPPER-1   lpt HOLSTER-R
 -o-loc- GRIPPER-2   lpt HOLSTER-L
 -o-loc- GRIPPER-3   lpt HOLSTER-C
BLOCK# 5 OFFSET 20000
 -vu- BAR 1 7 lpt UNIT_1 ... lpt 605 1
BLOCK# 6 OFFSET 20000
 -grip- PART 1 $$$ ...
 -grip- BAR 1 $$$ ...
 -grip- PART 1 lpt PFIXTURE ...
 -grip- BAR 1 lpt PFIXTURE ...
 -grip- PART 1 lpt PEDESTAL ...
 -grip- CYLINDER 1 lpt V-VFIXTURE ...
";

pub fn data() -> TaskData<'static> {
    static STORE: OnceLock<Store> = OnceLock::new();
    STORE.get_or_init(|| from(TEXT)).view()
}

/// The data without the lines that contain one of `words`, for tests of missing data.
pub fn without(words: &[&str]) -> Store {
    let lines = TEXT.lines().filter(|line| !words.iter().any(|word| line.contains(word)));
    from(&lines.collect::<Vec<_>>().join("\n"))
}

fn from(text: &str) -> Store {
    let source = Source { name: "test.blk".to_owned(), text: text.into() };
    match Store::from_sources(vec![source]) {
        Ok((store, _)) => store,
        Err(report) => panic!("{report}"),
    }
}
