//! What is said about files that are wrong.

use std::path::Path;

use meniscus::scene::particles::{ReadError, Taken, read_as};

use super::writers::{self, Legacy, Mode, Order, Packing, Sample, Store, Xml};

#[track_caller]
fn error(name: &str, bytes: &[u8]) -> ReadError {
    match super::parse(name, bytes) {
        Err(error) => error,
        Ok(set) => panic!("{name} was read: {set:?}"),
    }
}

/// The whole message with its place, as a person sees it.
#[track_caller]
fn says(name: &str, bytes: impl AsRef<[u8]>, expected: &str) {
    assert_eq!(error(name, bytes.as_ref()).to_string(), expected);
}

const VTK: &str = "# vtk DataFile Version 4.2\nt\nASCII\nDATASET POLYDATA\n";

#[test]
fn the_name_must_tell_the_format() {
    let unknown = error("a.obj", b"x");
    assert_eq!(unknown.message, "`.obj` is not the extension of a particle file");
    assert_eq!(
        unknown.hint.unwrap(),
        "known are .vtk, .vtu, .vtp, .ply, .bgeo, .bgeo.gz, .xyz, .csv, .json, .pdb, .ptc"
    );
    says("particles", b"x", "a particle file needs an extension that tells its format");
    for name in ["a.vtk", "a.vtu", "a.vtp", "a.ply", "a.bgeo", "a.bgeo.gz", "a.xyz", "a.csv", "a.json"] {
        says(name, b"", "byte 0: the file is empty");
    }
}

#[test]
fn legacy_vtk_says_what_is_wrong() {
    says("a.vtk", "<VTKFile>", "line 1, column 1: expected `# vtk DataFile Version`, found `<VTKFile>`");
    assert_eq!(error("a.vtk", b"<VTKFile>").hint.unwrap(), "an XML file's extension is .vtu or .vtp");
    says("a.vtk", "# vtk DataFile Version 6.0\nt\n", "line 1, column 24: versions 1 to 5 are known, found `6.0`");
    says("a.vtk", "# vtk DataFile Version 3.0\nt\nTEXT\n", "line 3, column 1: expected ASCII or BINARY, found `TEXT`");
    says("a.vtk", VTK, "line 5, column 1: expected POINTS, found the end of the file");
    let grid = VTK.replace("POLYDATA", "STRUCTURED_POINTS");
    let message = "expected the dataset UNSTRUCTURED_GRID or POLYDATA, found `STRUCTURED_POINTS`";
    says("a.vtk", grid, &format!("line 4, column 9: {message}"));
    let points = |rest: &str| format!("{VTK}POINTS {rest}");
    says("a.vtk", points("many float\n"), "line 5, column 8: expected the number of points, found `many`");
    says("a.vtk", points("-1 float\n"), "line 5, column 8: expected the number of points, found `-1`");
    says("a.vtk", points("1 quad\n1 2 3\n"), "line 5, column 10: expected a type such as float, found `quad`");
    let word = "points: expected a number of type f32, found `two`";
    says("a.vtk", points("1 float\n1 two 3\n"), &format!("line 6, column 3: {word}"));
    let short = "points: expected 6 numbers, found 5 before the end of the file";
    says("a.vtk", points("2 float\n1 2 3\n4 500\n"), &format!("line 8, column 1: {short}"));
    let lie = "points: expected 3000000000 numbers, but the rest of the file can hold at most 3";
    says("a.vtk", points("1000000000 float\n1 2 3\n"), &format!("line 6, column 1: {lie}"));
    let rows = "POINT_DATA has 2 rows, but there are 1 points";
    says("a.vtk", points("1 float\n1 2 3\nPOINT_DATA 2\n"), &format!("line 7, column 13: {rows}"));
    let keyword = error("a.vtk", points("1 float\n1 2 3\n4 5 6\n").as_bytes());
    assert_eq!(keyword.to_string(), "line 7, column 1: expected a keyword, found `4`");
    assert_eq!(keyword.hint.unwrap(), "the data before it may be shorter or longer than its header says");
}

#[test]
fn binary_vtk_says_what_is_wrong() {
    let mut bytes = VTK.replace("ASCII", "BINARY").into_bytes();
    bytes.extend(b"POINTS 3 float\n");
    let start = bytes.len();
    bytes.extend([0; 30]);
    says("a.vtk", &bytes, &format!("byte {start}: points: expected 36 bytes, found 30 before the end of the file"));
    let text = String::from_utf8(bytes[..start].to_vec()).unwrap();
    for (count, expected) in [("2000000000", "24000000000 bytes"), ("9000000000000000000", "numbers are more than")] {
        let message = error("a.vtk", text.replace(" 3 ", &format!(" {count} ")).as_bytes()).message;
        assert!(message.contains(expected), "{message}");
    }
}

fn vtu(attributes: &str, points: &str) -> String {
    format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" {attributes}>\n<UnstructuredGrid>\n\
         <Piece NumberOfPoints=\"2\">\n<Points>\n{points}\n</Points>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n"
    )
}

#[test]
fn xml_vtk_says_what_is_wrong() {
    let array =
        |more: &str| format!("<DataArray type=\"Float32\" Name=\"P\" NumberOfComponents=\"3\" {more}</DataArray>");
    let file = |more: &str| vtu("", &array(more));
    says("a.vtu", "<a>", "line 1, column 4: expected `</VTKFile>`, found the end of the file");
    let whole = file(">1 2 3 4 5 6");
    let cut = &whole[..whole.find("\n</Points>").unwrap()];
    says("a.vtu", cut, "line 6, column 83: expected `</VTKFile>`, found the end of the file");
    let tag = error("a.vtu", &cut.as_bytes()[..cut.len() - 3]).to_string();
    assert!(tag.starts_with("line 6, column 1: this element does not end: "), "{tag}");
    says("a.vtu", vtu("", ""), "line 4, column 1: expected an array in `Points`, found none");
    let count = "array `P`: expected 6 numbers, found 5 before the end of the file";
    says("a.vtu", file(">1 2 3 4 50000"), &format!("line 6, column 73: {count}"));
    says("a.vtu", file(">1 2 3 4 5 6 7"), "line 6, column 72: array `P`: expected 6 numbers, found more");
    let size = "line 6, column 1: array `P`: expected 24 bytes, found";
    says("a.vtu", file("format=\"binary\">DAAAAAAAAAAAAAAAAAAAAA=="), &format!("{size} 12 in its header"));
    let few = "line 6, column 1: array `P`: expected 28 bytes, found at most 12 in its base64 text";
    says("a.vtu", file("format=\"binary\">GAAAAAAAAAAAAAAA"), few);
    let wrong = error("a.vtu", file("format=\"binary\">GAAA!AAA").as_bytes());
    assert!(wrong.to_string().starts_with("line 6, column 1: array `P`: wrong base64: "), "{wrong}");
    let appended = "line 6, column 1: array `P`: expected an appended section, found none";
    says("a.vtu", file("format=\"appended\" offset=\"0\">"), appended);
    says("a.vtu", file("format=\"appended\">"), "line 6, column 1: an appended array needs an `offset`");
    let format = "expected the format ascii, binary or appended, found `text`";
    says("a.vtu", file("format=\"text\">"), &format!("line 6, column 1: {format}"));
    let components = file(">1 2").replace("\"3\"", "\"1\"");
    says("a.vtu", components, "line 6, column 1: expected points of 3 numbers, found 1 components");
    let kind = "expected a type such as Float32, found `Float31`";
    says("a.vtu", file(">1 2").replace("Float32", "Float31"), &format!("line 6, column 1: {kind}"));
    let grid = file(">1 2").replace("UnstructuredGrid\" >", "PUnstructuredGrid\" >");
    let message = "line 2, column 1: expected UnstructuredGrid or PolyData, found `PUnstructuredGrid`";
    says("a.vtu", grid, message);
    let lzma = vtu("compressor=\"vtkLZMADataCompressor\"", &array("format=\"binary\">GAAA"));
    says("a.vtu", &lzma, "line 2, column 1: the data is compressed by LZMA, which is not read");
    let hint = error("a.vtu", lzma.as_bytes()).hint.unwrap();
    assert_eq!(hint, "save the file with zlib or LZ4 compression or with none");
    let latin = [&file(">1 2").into_bytes()[..60], b"\xe9"].concat();
    says("a.vtu", &latin, "line 3, column 4: expected XML, found `\u{fffd}`");
}

#[test]
fn appended_data_must_be_there_once() {
    let how = Xml { mode: Mode::AppendedRaw, packing: Packing::None, wide: false, order: Order::Little, poly: false };
    let good = writers::xml_vtk(&Sample::new(4), how);
    let start = good.windows(4).position(|w| w == b"\n  _").unwrap();
    let cut = error("a.vtu", &good[..start + 10]);
    assert!(cut.place.is_some() && cut.message.contains("end of the file"), "{cut}");
    // An array that is far longer than the others, named again and again.
    let array = "<DataArray type=\"UInt8\" Name=\"NAME\" format=\"appended\" offset=\"0\"/>";
    let arrays: String = (0..100).map(|i| array.replace("NAME", &format!("a{i}"))).collect();
    let head = format!(
        "<VTKFile type=\"PolyData\"><Piece NumberOfPoints=\"50000\"><PointData>{arrays}</PointData><Points>\
         <DataArray type=\"UInt8\" NumberOfComponents=\"3\" format=\"appended\" offset=\"50004\"/></Points></Piece>\
         <AppendedData encoding=\"raw\">_"
    );
    let mut bytes = head.into_bytes();
    for size in [50_000_u32, 150_000] {
        bytes.extend(size.to_le_bytes());
        bytes.extend(vec![0; size as usize]);
    }
    let claimed = error("a.vtp", &bytes);
    assert!(claimed.message.contains("claim"), "{claimed}");
}

#[test]
fn xml_vtk_says_where_the_whole_file_is_wrong() {
    let file = |more: &str| format!("<?xml version=\"1.0\"?>\n <VTKFile type=\"PolyData\"{more}></VTKFile>");
    says("a.vtp", file(""), "line 2, column 2: expected a `Piece`, found none");
    let lzma = error("a.vtp", file(" compressor=\"vtkLZMADataCompressor\"").as_bytes());
    assert_eq!(lzma.to_string(), "line 2, column 2: the data is compressed by LZMA, which is not read");
}

#[test]
fn lists_of_files_say_which_to_name() {
    let pvd = "<VTKFile type=\"Collection\"><Collection>\n<DataSet timestep=\"0\" part=\"0\" file=\"a/dd_0.vtu\"/>\n\
        <DataSet timestep=\"1\" part=\"0\" file=\"a/dd_1.vtu\"/></Collection></VTKFile>";
    let list = error("a.pvd", pvd.as_bytes());
    assert_eq!(list.to_string(), "line 2, column 38: this lists 2 files and holds no particles itself");
    assert_eq!(list.hint.unwrap(), "name one of them, such as `a/dd_0.vtu`, or all by `#` in place of their numbers");
    for name in ["a.pvtu", "a.PVTP", "a.vtm"] {
        let one = error(name, b"<PUnstructuredGrid><Piece Source='dd_0.vtu'/></PUnstructuredGrid>");
        assert_eq!(one.message, "this lists one file and holds no particles itself");
        assert_eq!(one.hint.unwrap(), "name `dd_0.vtu` instead");
    }
    says("a.pvd", "file=", "line 1, column 1: this should list files, and names none");
}

#[test]
fn zlib_blocks_must_hold_what_they_say() {
    let how = Xml { mode: Mode::AppendedRaw, packing: Packing::Zlib, wide: true, order: Order::Little, poly: false };
    let good = writers::xml_vtk(&Sample::new(4), how);
    let start = good.windows(3).position(|w| w == b"  _").unwrap() + 3;
    // The first array is the radius: one block, then the size of all and of the last.
    let with = |word: usize, value: u64| {
        let mut bytes = good.clone();
        bytes[start + 8 * word..start + 8 * word + 8].copy_from_slice(&value.to_le_bytes());
        error("a.vtu", &bytes).message
    };
    assert_eq!(with(0, u64::MAX), "array `radius`: expected 8 bytes, found 18446744073709551615 in its header");
    assert_eq!(with(2, 7), "array `radius`: expected 8 bytes, found 7 in its header");
    let claimed = with(3, 1 << 40);
    assert!(claimed.contains("array `radius`: it and those before it claim"), "{claimed}");
    assert!(with(3, 3).contains("block 1 of 1: the zlib data is damaged or cut off"), "{}", with(3, 3));
}

#[test]
fn ply_says_what_is_wrong() {
    let file = |header: &str, body: &str| format!("ply\nformat ascii 1.0\n{header}\nend_header\n{body}");
    let xyz = "element vertex 2\nproperty float x\nproperty float y\nproperty float z";
    says("a.ply", "plyx\n", "line 1, column 1: expected `ply`, found `plyx`");
    says("a.ply", "ply\nformat ascii 1.0\n", "line 3, column 1: expected `end_header`, found the end of the file");
    let format = "expected the format `ascii`, `binary_little_endian` or `binary_big_endian`, found `binary`";
    says("a.ply", "ply\nformat binary 1.0\nend_header\n", &format!("line 2, column 8: {format}"));
    says("a.ply", "ply\nelement vertex 0\nend_header\n", "line 4, column 1: the header has no line `format`");
    says("a.ply", file("element face 0", ""), "line 5, column 1: the header has no element `vertex`");
    says("a.ply", file("elements 3", ""), "line 3, column 1: expected `end_header`, found `elements`");
    says("a.ply", file("property float x", ""), "line 3, column 17: a property before any element");
    let kind = "expected a type such as `float`, found `real`";
    says("a.ply", file("element vertex 1\nproperty real x", ""), &format!("line 4, column 10: {kind}"));
    says(
        "a.ply",
        file("element vertex all", ""),
        "line 3, column 16: expected how many `vertex` there are, found `all`",
    );
    let no_z = xyz.replace(" z", " w");
    says(
        "a.ply",
        file(&no_z, "1 2 3\n4 5 6\n"),
        "line 3, column 9: element `vertex` has no properties `x`, `y` and `z`",
    );
    says(
        "a.ply",
        file(xyz, "1 2 3\n4 five 6\n"),
        "line 9, column 3: property `y`: expected a number of type f32, found `five`",
    );
    says(
        "a.ply",
        file(xyz, "1 2 3\n4 5\n"),
        "line 10, column 1: property `z`: expected 1 number, found the end of the file",
    );
    let lie = xyz.replace("vertex 2", "vertex 9000000000000000000");
    assert!(error("a.ply", file(&lie, "1 2 3\n").as_bytes()).message.contains("found the end of the file"));
    let binary = file(&lie, "1 2 3\n").replace("ascii", "binary_little_endian");
    assert!(error("a.ply", binary.as_bytes()).message.contains("found 6 before the end of the file"));
    let list = "element face 1\nproperty list char float a\n".to_owned() + xyz;
    let mut negative = file(&list, "").replace("ascii", "binary_little_endian").into_bytes();
    let at = negative.len() + 1;
    negative.push(0xff);
    says("a.ply", &negative, &format!("byte {at}: list `a`: a length of -1"));
}

#[test]
fn bgeo_says_what_is_wrong() {
    says("a.bgeo", "ply\nformat", "byte 0: expected `Bgeo` or `\\x7fNSJb`, found `ply\\nf`");
    says("a.bgeo", "Bge", "byte 0: the magic number: expected 5 bytes, found 3 before the end of the file");
    let good = writers::classic_bgeo(&Sample::new(3));
    let with = |at: usize, number: i32| {
        let mut bytes = good.clone();
        bytes[at..at + 4].copy_from_slice(&number.to_be_bytes());
        error("a.bgeo", &bytes).to_string()
    };
    assert_eq!(with(5, 7), "byte 5: expected version 5, found 7");
    assert_eq!(with(9, -1), "byte 9: expected the number of points, found -1");
    let found = good.len() - 113;
    assert_eq!(
        with(9, i32::MAX),
        format!(
            "byte 113: 2147483647 points of 36 bytes: expected 77309411292 bytes, found {found} before the end of the file"
        )
    );
    assert_eq!(with(47, 9), "byte 47: attribute `id`: expected type 0, 1, 4 or 5, found 9");
    assert_eq!(with(47, 2), "byte 47: attribute `id`: strings in rows are not known");

    let packed = writers::gzip(&good);
    let cut = error("a.bgeo.gz", &packed[..packed.len() / 2]).to_string();
    assert!(cut.contains("of the unpacked data: the gzip data is damaged or cut off"), "{cut}");
    let mut damaged = packed.clone();
    let checksum = packed.len() - 8;
    damaged[checksum] ^= 1;
    let damaged = error("a.bgeo", &damaged).to_string();
    assert!(damaged.contains("the gzip data is damaged or cut off"), "a wrong checksum is found out: {damaged}");
    let mut lying = good.clone();
    lying[9..13].copy_from_slice(&i32::MAX.to_be_bytes());
    let lying = error("a.bgeo", &writers::gzip(&lying)).to_string();
    assert!(lying.starts_with("byte 113 of the unpacked data: 2147483647 points of 36 bytes"), "{lying}");
}

#[test]
fn json_bgeo_says_what_is_wrong() {
    let good = writers::json_bgeo(&Sample::new(9), Store::Pages, Order::Little);
    let replaced = |from: &[u8], to: &[u8]| {
        let at = good.windows(from.len()).position(|w| w == from).unwrap();
        let mut bytes = good.clone();
        bytes.splice(at..at + from.len(), to.iter().copied());
        error("a.bgeo", &bytes).message
    };
    let count = |n: i64| [b"\x27\x0apointcount\x14".as_slice(), &n.to_le_bytes()].concat();
    assert_eq!(replaced(&count(9), &count(8)), "attribute `P`: expected 24 numbers, found 27");
    assert!(replaced(&count(9), &count(10)).contains("attribute `P`: page 2 needs 6 numbers, found 3"));
    assert!(replaced(&count(9), &count(i64::MAX)).contains("need more data than there is"));
    assert_eq!(replaced(&count(9), &count(-1)), "binary JSON: expected a count, found -1");
    assert_eq!(replaced(b"\x27\x01P", b"\x27\x01Q"), "expected a point attribute `P`, found none");
    assert_eq!(
        replaced(b"\x27\x08fpreal32", b"\x27\x08fpreal31"),
        "binary JSON: expected a storage such as `fpreal32`, found `fpreal31`"
    );
    assert_eq!(replaced(b"\x26\x07", b"\x26\x09"), "binary JSON: string 9 was not defined");
    assert_eq!(replaced(b"\x27\x04info", b"\x99\x04info"), "binary JSON: no token begins with 0x99");
}

#[test]
fn xyz_and_csv_say_what_is_wrong() {
    let raw = [&[0, 0, 200, 66][..]; 10].concat();
    says("a.xyz", &raw, "byte 36: expected triples of 4-byte floats, found 40 bytes (12 to a particle leave 4 over)");
    says("a.xyz", "1 2 3\n1 2\n", "line 2, column 1: expected 3 numbers on a line, found 2");
    says("a.xyz", "1 2 3\n1 two 3\n", "line 2, column 3: expected a number, found `two`");

    says("a.csv", "x,y,z\n1,2\n", "line 2, column 1: expected 3 cells as in the header, found 2");
    says("a.csv", "x,y,z\n1,2,3\n1,2,three\n", "line 3, column 5: column `z`: expected a number, found `three`");
    let no_position = error("a.csv", b"a,b\n1,2\n");
    assert_eq!(no_position.to_string(), "line 1, column 1: no columns for the position: the header has `a`, `b`");
    assert!(no_position.hint.unwrap().starts_with("`x`, `y`, `z` or"));
    says("a.csv", "1,2,3,4\n", "line 1, column 1: expected a header line with names, found 4 numbers");
    says("a.csv", "# nothing\n\n", "line 3, column 1: expected a header line, found the end of the file");
    says("a.csv", "x,y,z\n1,2,3,,\n", "line 2, column 1: expected 3 cells as in the header, found 5");
    says("a.csv", "# a\na,b\n1,2\n", "line 2, column 1: no columns for the position: the header has `a`, `b`");
    let names = error("a.xyz", b"# a\nx y z\n1 2 3\n");
    assert_eq!(names.to_string(), "line 2, column 1: expected a number, found `x`");
    assert_eq!(names.hint.unwrap(), "a file that begins with a line of names is read with the extension .csv");
    says("a.csv", "\u{feff}x,y,z\n1,2\n", "line 2, column 1: expected 3 cells as in the header, found 2");
    says("a.csv", "\u{feff}a,b\n", "line 1, column 1: no columns for the position: the header has `a`, `b`");
    says("a.csv", "x,y,z\none,2,3\n", "line 2, column 1: column `x`: expected a number, found `one`");
    says("a.csv", "a,x,y,z\nb,1,2,3\nc,1,2,N/A\n", "line 3, column 7: column `z`: expected a number, found `N/A`");
    let late = super::parse("a.csv", b"x,y,z,a\n1,2,3,4\n1,2,3,four\n").unwrap();
    assert_eq!(late.notes, ["column `a` is left out: it holds text"]);
}

#[test]
fn json_pdb_and_ptc_say_what_is_wrong() {
    says(
        "a.json",
        "[[1, 2, 3], [4, 5]]",
        "line 1, column 13: row 2: `position` has 2 numbers, and 3 in the rows before",
    );
    let rows = r#"[{"x": 1, "y": 2, "z": 3}, {"x": 1, "y": 2}]"#;
    says("a.json", rows, "line 1, column 28: row 2: `z` has 0 numbers, and 1 in the rows before");
    says("a.json", "[[1, 2, three]]", "line 1, column 9: expected a number, found `three`");
    says("a.json", "[[1, 2, 3]", "line 1, column 11: expected `]`, found the end of the file");
    says("a.json", "[[1,2,3],4,5]", "line 1, column 10: row 2: a single value, and a list in the rows before");
    says("a.json", "[1,2,3,[4,5,6]]", "line 1, column 8: row 4: a list, and a single value in the rows before");
    says("a.json", "{\"x\": [1], \"x\": [2]}", "line 1, column 17: `x` comes twice");
    says("a.json", "[[1 2 3]]", "line 1, column 5: expected `,` or `]`, found `2`");
    says("a.json", "{\"a\": [1, 2]}", "line 1, column 1: no position: there is `a`");
    says("a.json", "{x: 1}", "line 1, column 2: expected a name in quotes");
    says("a.json", "[[1,2,3]] 4", "line 1, column 11: expected the end of the file, found `4`");
    says("a.json", "[".repeat(100_000), "line 1, column 18: more than 16 lists and objects in one another");
    says("a.pdb", "x", "byte 0: expected the number 670, which begins a PDB file, found `x`");
    let bytes = writers::pdb(&Sample::new(9), false, Order::Little);
    let cut = "byte 232: channel `position`: expected 108 bytes, found 8 before the end of the file";
    says("a.pdb", &bytes[..240], cut);
    says("a.ptc", "pptx", "byte 0: expected `pptc`, found `pptx`");
    let mut bytes = writers::ptc(&Sample::new(9), 0);
    bytes[8..16].copy_from_slice(&f64::NAN.to_le_bytes());
    says("a.ptc", &bytes, "byte 8: expected the number of points, found NaN");
    bytes[8..16].copy_from_slice(&4.0e9_f64.to_le_bytes());
    assert!(error("a.ptc", &bytes).message.contains("144000000000 bytes"), "{}", error("a.ptc", &bytes));
}

#[test]
fn a_cut_text_never_passes_for_a_whole_one() {
    let sample = Sample::new(30);
    let binary = Legacy { binary: true, five: true, poly: false };
    let bytes = writers::legacy_vtk(&sample, binary);
    // Without a line that says how many arrays follow, a file that ends between two blocks is whole.
    let points = bytes.windows(7).position(|w| w == b"POINTS ").unwrap();
    let whole = [points + 16 + 30 * 12, bytes.len() - 1];
    for end in 1..whole[0] {
        error("a.vtk", &bytes[..end]);
    }
    for (name, bytes) in [
        ("a.ply", writers::ply(&sample, Some(Order::Big))),
        ("a.bgeo", writers::gzip(&writers::classic_bgeo(&sample))),
        ("a.bgeo", writers::json_bgeo(&sample, Store::Packs, Order::Little)),
    ] {
        // The faces of the PLY, its last 5 bytes, are of no interest and may be missing.
        for end in 1..bytes.len() - 5 {
            error(name, &bytes[..end]);
        }
    }
}

#[test]
fn attributes_that_a_scene_renames_must_be_there() {
    let as_named = |file: &[u8], old: &str| {
        let taken = Taken { names: vec![("velocity".to_owned(), old.to_owned())], ..Taken::default() };
        read_as(Path::new("a.csv"), file, &taken).unwrap_err()
    };
    let error = as_named(b"x,y,z,vel_x,vel_y,vel_z\n1,2,3,4,5,6\n", "vell");
    assert_eq!(error.to_string(), "there is no attribute `vell`");
    assert_eq!(error.hint.unwrap(), "did you mean `vel`?");
    let error = as_named(b"x,y,z,mass,id\n1,2,3,4,5\n", "speed");
    assert_eq!(error.hint.unwrap(), "there are mass, id");
    assert_eq!(as_named(b"x,y,z\n1,2,3\n", "v").hint.unwrap(), "the file has positions only");
}
